/// A run within a time budget.
#pragma once

#include <csignal>
#include <string>
#include <vector>

#include "suite/core/clock.h"

namespace physinv {

struct CampaignOptions;
struct Case;

/// What of a budget is not for cases.
struct BudgetUse {
  Seconds begun = {};  ///< the clock when the program began
  bool pages = false;  ///< are they written at the end?
};
/// A coarse pass first. What is left of the budget for cases: without what was
/// spent so far and what the end will take.
void follow_budget(CampaignOptions& campaign,
                   const std::vector<Case>& cases,
                   const BudgetUse& use);

/// Ends the campaign that runs while it lives as a signal to stop would, once
/// the budget is spent and a little more: running stages save their state
/// down. Nothing without a budget.
class BudgetAlarm {
 public:
  explicit BudgetAlarm(double budget);
  ~BudgetAlarm();
  BudgetAlarm(const BudgetAlarm&) = delete;
  BudgetAlarm& operator=(const BudgetAlarm&) = delete;
  /// It rang, and there was no other request to stop.
  bool ended_it() const;

 private:
  bool set_ = false;
  struct sigaction old_ {};
};

/// Cases per experiment and n, where the budget left some out.
std::string left_out_text(const std::vector<std::string>& names);

}  // namespace physinv
