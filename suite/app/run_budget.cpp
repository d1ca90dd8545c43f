#include "suite/app/run_budget.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "suite/app/speeds.h"
#include "suite/core/clock.h"
#include "suite/harness/campaign.h"
#include "suite/harness/stop_signal.h"
#include "suite/planning/budget.h"
#include "suite/planning/predict.h"

namespace physinv {
namespace {

/// Shorter budgets are not spent on measuring speeds.
constexpr double kBudgetForTrials = 60;
/// What a running case may take beyond the budget, and how long it waits at
/// least: a budget of nothing starts nothing and needs no alarm.
constexpr double kBeyond = 1.04, kLeastSeconds = 0.2;
/// What comes after the last case, alone on the machine: writing down, and
/// pages by the case. A third of the budget at most.
constexpr double kEndingSeconds = 0.2, kPageSeconds = 0.012,
                 kMostOfBudget = 0.33;
/// Until a campaign counts signals.
constexpr suseconds_t kAgainMicroseconds = 50'000;

volatile std::sig_atomic_t rang = 0;

/// Sends SIGTERM only to a handler that counts it; nothing is killed.
void ring(int) {
  struct sigaction counting {};
  sigaction(SIGTERM, nullptr, &counting);
  if (counting.sa_handler == SIG_DFL || counting.sa_handler == SIG_IGN) {
    const itimerval again{{0, 0}, {0, kAgainMicroseconds}};
    setitimer(ITIMER_REAL, &again, nullptr);
    return;
  }
  rang = 1;
  kill(getpid(), SIGTERM);
}

/// What the cases will take, by short runs where the budget has room for them;
/// else only in proportion, by their counted operations.
std::vector<double> seconds_of(const std::vector<Case>& cases, double budget) {
  std::vector<double> seconds;
  if (budget < kBudgetForTrials) {
    for (const Case& c : cases) seconds.push_back(c.operations());
    return seconds;
  }
  Trials trials = known_speeds();
  for (const Cost& cost : predict(cases, trials))
    seconds.push_back(cost.seconds);
  trials.save();
  return seconds;
}

}  // namespace

void follow_budget(CampaignOptions& campaign,
                   const std::vector<Case>& cases,
                   const BudgetUse& use) {
  auto seconds = seconds_of(cases, campaign.time_budget);
  if (campaign.time_budget >= kBudgetForTrials)
    campaign.expected_seconds = seconds;
  const double pages =
      use.pages ? kPageSeconds * static_cast<double>(cases.size()) : 0;
  const Seconds spent = now() - use.begun;
  // A run that shares its cores ends later.
  const double shared = std::max(1.0, spent.wall / std::max(spent.cpu, 1e-3));
  const double ending = std::min(shared * (kEndingSeconds + pages),
                                 kMostOfBudget * campaign.time_budget);
  campaign.time_budget =
      std::max(1e-6, campaign.time_budget - ending - spent.wall);
  campaign.order = [cases, seconds = std::move(seconds)](
                       std::vector<std::size_t> queue,
                       const Finished& finished) {
    return budget_order(cases, std::move(queue), finished, seconds);
  };
}

BudgetAlarm::BudgetAlarm(double budget) {
  rang = 0;
  if (!(budget > 0)) return;
  struct sigaction action {};
  action.sa_handler = ring;
  action.sa_flags = SA_RESTART;
  sigaction(SIGALRM, &action, &old_);
  double whole = 0;
  const double part =
      std::modf(std::max(kBeyond * budget, kLeastSeconds), &whole);
  const itimerval once{
      {0, 0},
      {static_cast<time_t>(whole), static_cast<suseconds_t>(1e6 * part)}};
  set_ = setitimer(ITIMER_REAL, &once, nullptr) == 0;
}

BudgetAlarm::~BudgetAlarm() {
  if (!set_) return;
  const itimerval none{};
  setitimer(ITIMER_REAL, &none, nullptr);
  sigaction(SIGALRM, &old_, nullptr);
}

bool BudgetAlarm::ended_it() const { return rang != 0 && stop_signals() == 1; }

std::string left_out_text(const std::vector<std::string>& names) {
  std::map<std::string, std::vector<std::string>> seeds;
  for (const auto& name : names) {
    const auto at = name.rfind("/seed=");
    seeds[name.substr(0, at)].push_back(name.substr(at + 6));
  }
  std::string text;
  for (const auto& [chain, left] : seeds)
    text += fmt::format("  {} seeds {}\n", chain, fmt::join(left, ", "));
  return text;
}

}  // namespace physinv
