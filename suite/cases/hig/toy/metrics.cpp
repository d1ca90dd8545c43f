#include "suite/cases/hig/toy/metrics.h"

#include <fmt/format.h>

#include <cmath>

#include "suite/core/math.h"
#include "suite/core/oracle.h"

namespace physinv::toy {
namespace {

constexpr double kNearOne = 0.99;

/// Weights of the network as its parameters are laid out.
struct Weights {
  explicit Weights(VectorIn<double> theta)
      : first(theta.segment(0, kHidden)),
        bias(theta.segment(kHidden, kHidden)),
        output(Eigen::Map<const Batch<double>>(
                   theta.data() + 2 * kHidden, kHidden, 2)
                   .transpose()),
        shift(theta.segment(4 * kHidden, 2)) {}

  /// Neurons x points.
  Batch<double> hidden(const Batch<double>& x) const {
    return ((first * x).colwise() + bias).unaryExpr([](double z) {
      return math::tanh(z);
    });
  }

  Vector<double> first, bias;
  Batch<double> output;
  Vector<double> shift;
};

void evaluate(const Snapshot& s, double gamma, VectorOut<double> values) {
  values.setZero();
  // Another network on another problem has none of these numbers.
  if (s.parameters.size() != 4 * kHidden + 2 || s.y.rows() != 2) return;
  const Weights weights(s.parameters);
  const Batch<double> h = weights.hidden(s.oracle.given());
  const Batch<double> r = s.y - s.oracle.observations();
  const auto points = static_cast<double>(r.cols());
  values(kFirstLoss) = r.row(0).squaredNorm() / (2 * points);
  values(kSecondLoss) = r.row(1).squaredNorm() / (2 * points);
  values(kWeightNorm) = s.parameters.norm();
  values(kBeyond) = static_cast<double>((h.array().abs() > kNearOne).count()) /
                    static_cast<double>(h.size());
  const Batch<double> point = Batch<double>::Constant(1, 1, kPoint);
  const Vector<double> y =
      weights.output * weights.hidden(point).col(0) + weights.shift;
  values(kPathFirst) = y(0);
  values(kPathSecond) = gamma * y(1);
  for (Index k = 0; k < kHidden; ++k) {
    const double mean = h.row(k).mean();
    values(kMeans + k) = mean;
    values(kDeviations + k) =
        std::sqrt((h.row(k).array() - mean).square().mean());
  }
}

}  // namespace

Metrics metrics(double gamma) {
  Metrics all{.name = fmt::format("toy gamma={}", gamma),
              .rows = {"loss_1", "loss_2", "theta", "beyond", "z_1", "z_2"},
              .evaluate = [=](const Snapshot& s, VectorOut<double> values) {
                evaluate(s, gamma, values);
              }};
  for (const char* what : {"mean", "deviation"})
    for (Index k = 0; k < kHidden; ++k)
      all.rows.push_back(fmt::format("{}_{}", what, k));
  return all;
}

}  // namespace physinv::toy
