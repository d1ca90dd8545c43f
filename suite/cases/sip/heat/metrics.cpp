#include "suite/cases/sip/heat/metrics.h"

#include <cmath>

#include "problems/heat/heat.h"
#include "suite/core/math.h"
#include "suite/core/oracle.h"

namespace physinv::heat {
namespace {

double error_of(const Batch<double>& x, const Batch<double>& truth) {
  return (x - truth).colwise().lpNorm<1>().mean();
}

/// Energy that a filter leaves.
class Band {
 public:
  Band(const HeatOptions& options, Index columns)
      : heat_(options), seen_(heat_.fft().field(), columns) {}

  template <class F>
  double operator()(const Batch<double>& field, F&& gain) {
    heat_.filter<double>(
        field, heat_.exponents().unaryExpr(gain), seen_, work_);
    return seen_.squaredNorm();
  }

 private:
  HeatModes heat_;
  Batch<double> seen_;
  Workspace work_;
};

void evaluate(const Snapshot& s, VectorOut<double> values) {
  values.setZero();
  const HeatOptions* heat = heat_options(s.oracle.inspect());
  if (heat == nullptr) return;  // these numbers are of no other problem
  const Batch<double>&truth = s.oracle.data().x, &y = s.oracle.observations();
  const Batch<double> error = s.x - truth;
  values(kError) = error_of(s.x, truth);
  values(kClamped) = error_of(s.x.cwiseMax(0), truth);
  const Vector<double> means = y.colwise().mean();
  values(kOfMean) = error_of(means.transpose().replicate(y.rows(), 1), truth);
  values(kOfObserved) = error_of(y, truth);

  Band band(*heat, s.x.cols());
  const auto coarse = [](double e) { return e > 0 && e <= 1 ? 1.0 : 0.0; };
  const auto fine = [](double e) { return e > 4 && e <= 16 ? 1.0 : 0.0; };
  values(kCoarse) = band(error, coarse) / band(truth, coarse);
  values(kFine) = band(error, fine) / band(truth, fine);
  const auto raw = [](double e) { return math::exp(e); };
  values(kOfInverse) = std::sqrt(band(y, raw)) / truth.norm();
}

}  // namespace

Metrics metrics() {
  return {.name = "heat",
          .rows = {"error",
                   "clamped",
                   "coarse",
                   "fine",
                   "of_mean",
                   "of_observed",
                   "of_inverse"},
          .evaluate = evaluate};
}

}  // namespace physinv::heat
