// Values of a run that claims.md names.
#include "suite/cases/common/claims.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "suite/cases/sip/poisson/metrics.h"
#include "suite/evidence/training.h"
#include "suite/harness/networks.h"
#include "suite/results/crowded.h"

namespace physinv::poisson {
namespace {

/// The first trains with every seed; the second, with ten times its rate, does
/// not, or ends worse.
Labelled largest_rate(const Select& of,
                      const Select& tenfold,
                      const RunValue& error) {
  const RunValue value = or_infinite(error);
  return [=](const std::string& label) -> std::vector<Condition> {
    return {below(label + ", error over the start's, worst seed",
                  highest(of, over(value, value_after(metric(kError), 0))),
                  1),
            above("ten times its rate, error over that, worst seed",
                  worst_ratio(tenfold, of, value),
                  1),
            reported("median seed", median_ratio(tenfold, of, value))};
  };
}

/// At the last measured point up to there, if there is one.
std::optional<double> error_by(const Run& run, double seconds) {
  const auto& all = run.stage->curve.seconds;
  const auto after = std::upper_bound(all.begin(), all.end(), seconds);
  if (after == all.begin()) return {};
  return CurveRow{*run.stage, "metrics", kError}(
      static_cast<Index>(after - all.begin()) - 1);
}
/// Error over that of another run when the shorter one ends; of runs that had
/// their cores to themselves.
RunValue over_at_equal_time(const Select& other) {
  return [=](const Run& run) -> std::optional<double> {
    const auto rival = run.beside(other);
    if (!rival || is_crowded(*run.stage) || is_crowded(*rival->stage))
      return {};
    const double seconds = std::min(run.stage->curve.seconds.back(),
                                    rival->stage->curve.seconds.back());
    const auto error = error_by(run, seconds),
               theirs = error_by(*rival, seconds);
    if (!error || !theirs) return {};
    return *error / *theirs;
  };
}
/// Error of direct estimates over that of zero, mean over the examples.
RunValue direct_error(std::optional<Precision> precision = {}) {
  return [=](const Run& run) -> std::optional<double> {
    const Batch<double>&x = run.stage->x, &truth = run.record->data.x;
    if (precision && run.record->info.precision != *precision) return {};
    if (x.cols() == 0 || truth.cols() != x.cols()) return {};
    return (x - truth).lpNorm<1>() / truth.lpNorm<1>();
  };
}
/// Mean loss at the end over that of the start.
std::optional<double> growth(const Run& run) {
  const Batch<double>& loss = run.stage->curve.loss;
  if (loss.cols() < 2) return {};
  return loss.rightCols(1).mean() / loss.col(0).mean();
}
/// Largest loss over the one before, along the curve of every example.
std::optional<double> steepest_rise(const Run& run) {
  const Batch<double>& loss = run.stage->curve.loss;
  if (loss.cols() < 2) return {};
  return (loss.rightCols(loss.cols() - 1).array() /
          loss.leftCols(loss.cols() - 1).array())
      .maxCoeff();
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("error", metric(kError));
  names.set("error_of_zero", metric(kOfZero));
  names.add("largest_rate", largest_rate);
  names.add("over_at_equal_time", over_at_equal_time);
  names.set("direct_error", direct_error());
  names.set("direct_error_in_double", direct_error(Precision::f64));
  names.set("direct_error_in_float", direct_error(Precision::f32));
  names.set("growth", growth);
  names.set("steepest_rise", steepest_rise);
  names.add("parameters", [](const std::string& of) { return parameters(of); });
  names.add("parameters_complex_once", parameters_complex_once);
  add_claims_of_folder(r, "sip/poisson", names);
}

}  // namespace physinv::poisson
