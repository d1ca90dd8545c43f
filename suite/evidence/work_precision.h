/// Run time against error of an experiment's methods: a setting is a method at
/// one n and precision, and where its curve is cut off is its budget.
///
/// Losses are means over the examples, divided by the lowest at which any
/// method starts on the same problems: so different n can be shown side by
/// side. Seconds are the batch's over n; where a method is judged by its
/// network on a test set, those of the training. Medians over the seeds that
/// all settings of one n have in common.
///
/// A run that failed counts: its loss is infinite from its failure on, after
/// all that it spent; so is a loss that is not finite.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv {

/// A setting's medians after one budget, and the losses' quantiles.
struct BudgetPoint {
  double seconds = 0, loss = 0;
  double low = 0, high = 0;  ///< 10 % and 90 % of the seeds
};

struct SettingHistory {
  std::string method;
  Index n = 0;
  Precision precision = Precision::f32;
  std::size_t seeds = 0;
  std::size_t failed = 0;           ///< of them
  std::vector<BudgetPoint> points;  ///< growing budgets; finite losses alone
  BudgetPoint end;                  ///< of the whole budget, finite or not
  /// Of the estimates from the true unknowns, where a problem knows them:
  /// median over the seeds of the examples' median |x - x*|, infinite of what
  /// failed or is not finite.
  std::optional<double> distance;
  bool crowded = false;  ///< its stages shared their cores
};

/// Settings whose chains are finished or failed. Losses that are not positive
/// have no ratio, and a failure after an unknown time has no place: such
/// settings have no points.
std::vector<SettingHistory> setting_histories(const Results& results,
                                              const std::string& experiment);

/// The lower-left hull: points that no other one beats in both, by time.
std::vector<BudgetPoint> work_precision_hull(
    const std::vector<SettingHistory>& settings);

/// Whether one of its points lies on the hull.
bool on_hull(const SettingHistory& setting,
             const std::vector<BudgetPoint>& hull);

/// Seconds until a loss; infinite if it is never reached.
double seconds_to(const SettingHistory& setting, double loss);

/// Adds the table `run_time_against_loss`, with the time to three targets, and
/// the figure of the same name. Nothing where no method solves anything.
void add_work_precision(
    Section& section,
    const Results& results,
    const std::string& experiment,
    const std::map<std::string, std::string>& method_titles);

}  // namespace physinv
