#include "suite/evidence/convergence_history.h"

#include <algorithm>

#include "suite/evidence/curve.h"
#include "suite/evidence/statistics.h"

namespace physinv {
namespace {

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

/// Simulations up to each point of a stage. A training counts them only at its
/// end; each of its updates takes as many.
std::vector<double> simulations_along(const StageRecord& s) {
  const Curve& curve = s.curve;
  const bool at_end_only = !curve.evaluations.empty() &&
                           curve.evaluations.back() == 0 && s.iterations > 0;
  if (!at_end_only) return curve.evaluations;
  const double each =
      simulations_of(s.counts) / static_cast<double>(s.iterations);
  std::vector<double> spent;
  for (const double iteration : curve.iteration)
    spent.push_back(each * iteration);
  return spent;
}

/// The points of a stage behind those before it.
void add_points(ConvergenceHistory& history, const StageRecord& s) {
  const double seconds = *history.all_seconds,
               simulations = *history.all_simulations;
  const std::vector<double> along = simulations_along(s);
  history.spread |= along != s.curve.evaluations;
  const Batch<double>* mean = mean_of(s);
  const Index points = mean == nullptr
                           ? s.curve.points()
                           : std::min(mean->cols(), s.curve.points());
  for (Index k = 0; k < points; ++k) {
    const auto at = static_cast<std::size_t>(k);
    add_point(history,
              seconds + s.curve.seconds[at],
              simulations + along[at],
              mean == nullptr ? Vector<double>(s.curve.loss.col(k))
                              : Vector<double>::Constant(1, CurveRow{s}(k)));
  }
  const double all_seconds = seconds + s.clocks.solve.wall,
               all_simulations = simulations + simulations_of(s.counts);
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
  add(history.all_simulations, knows_work(s), simulations_of(s.counts));
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

double simulations_of(const Counts& counts) {
  double sum = 0;
  for (const Counter c :
       {Counter::forward, Counter::vjp, Counter::jacobian, Counter::inverse})
    sum += static_cast<double>(counts[c]);
  return sum;
}

bool is_diagnostic(const Options& options) {
  return std::any_of(options.begin(), options.end(), [](const auto& option) {
    return option.first == "algorithm" && option.second == "diagnostic";
  });
}

}  // namespace physinv
