#include "suite/evidence/convergence_history.h"

#include <algorithm>

#include "suite/evidence/curve.h"
#include "suite/evidence/statistics.h"

namespace physinv {
namespace {

double simulations_of(const StageRecord& s) {
  return static_cast<double>(s.counts[Counter::forward] +
                             s.counts[Counter::vjp]);
}

void add_point(ConvergenceHistory& history,
               double seconds,
               double simulations,
               VectorIn<double> loss) {
  history.seconds.push_back(seconds);
  history.simulations.push_back(simulations);
  history.loss.emplace_back(loss);
}

/// The mean over a test set along the curve, if that is what is known of all.
const Batch<double>* mean_of(const StageRecord& s) {
  const auto mean = s.arrays.find("mean_loss");
  const bool some = s.curve.loss.rows() != s.loss.size();
  return some && mean != s.arrays.end() ? &mean->second : nullptr;
}

/// The points of a stage behind those before it.
void add_points(ConvergenceHistory& history, const StageRecord& s) {
  const double seconds = *history.all_seconds,
               simulations = *history.all_simulations;
  const Batch<double>* mean = mean_of(s);
  const Index points = mean == nullptr
                           ? s.curve.points()
                           : std::min(mean->cols(), s.curve.points());
  for (Index k = 0; k < points; ++k) {
    const auto at = static_cast<std::size_t>(k);
    add_point(history,
              seconds + s.curve.seconds[at],
              simulations + s.curve.evaluations[at],
              mean == nullptr ? Vector<double>(s.curve.loss.col(k))
                              : Vector<double>::Constant(1, CurveRow{s}(k)));
  }
  const double all_seconds = seconds + s.clocks.solve.wall,
               all_simulations = simulations + simulations_of(s);
  if (mean == nullptr) {
    // The estimate may be better than the end of the curve.
    if (s.loss.size() > 0)
      add_point(history, all_seconds, all_simulations, s.loss);
  } else if (s.stop == Stop::diverged) {
    add_point(history,
              all_seconds,
              all_simulations,
              Vector<double>::Constant(1, kInfinite));
  }
}

/// Does the record tell for how long it ran? Of a stage whose process was lost
/// it does not.
bool knows_time(const StageRecord& s) {
  return has_result(s) || s.clocks.total().wall > 0;
}
bool knows_work(const StageRecord& s) {
  return knows_time(s) && s.counts.knows(Counter::forward) &&
         s.counts.knows(Counter::vjp);
}

/// What a stage spent, finished or failed.
void add_spent(ConvergenceHistory& history, const StageRecord& s) {
  if (s.stop == Stop::skipped) return;
  const auto add = [](std::optional<double>& sum, bool known, double spent) {
    if (!known || !sum)
      sum.reset();
    else
      *sum += spent;
  };
  add(history.all_seconds, knows_time(s), s.clocks.solve.wall);
  add(history.all_simulations, knows_work(s), simulations_of(s));
}

}  // namespace

std::optional<ConvergenceHistory> history_of(const CaseRecord& found) {
  ConvergenceHistory history{.all_seconds = 0, .all_simulations = 0};
  for (const StageRecord& s : found.stages) {
    history.failed |= !has_result(s);
    if (!history.failed) add_points(history, s);
    add_spent(history, s);
  }
  if (!history.failed && found.stages.size() < found.info.stages.size())
    return {};
  return history;
}

bool is_diagnostic(const Options& options) {
  return std::any_of(options.begin(), options.end(), [](const auto& option) {
    return option.first == "algorithm" && option.second == "diagnostic";
  });
}

}  // namespace physinv
