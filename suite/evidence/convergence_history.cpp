#include "suite/evidence/convergence_history.h"

#include <algorithm>

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

}  // namespace

std::optional<ConvergenceHistory> history_of(const CaseRecord& found) {
  ConvergenceHistory history;
  double seconds = 0, simulations = 0;
  bool failed = false;
  for (const StageRecord& s : found.stages) {
    failed = s.stop == Stop::failed || s.stop == Stop::skipped;
    if (failed) break;
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
                                : Vector<double>(mean->col(k)));
    }
    seconds += s.clocks.solve.wall;
    simulations += static_cast<double>(s.counts[Counter::forward] +
                                       s.counts[Counter::vjp]);
    // The estimate may be better than the end of the curve.
    if (s.loss.size() > 0 && mean == nullptr)
      add_point(history, seconds, simulations, s.loss);
  }
  if (!failed && found.stages.size() < found.info.stages.size()) return {};
  return history;
}

bool is_diagnostic(const Options& options) {
  return std::any_of(options.begin(), options.end(), [](const auto& option) {
    return option.first == "algorithm" && option.second == "diagnostic";
  });
}

}  // namespace physinv
