#include "optimizers/half_inverse/tall_power.h"

#include <algorithm>
#include <cmath>

#include "suite/core/check.h"

namespace physinv::hig {

using namespace linalg;
namespace {

/// Values are looked for down to a part of the cut, so that one just below is
/// known; never below what the rounding of J leaves of them.
constexpr double kBelowCut = 0.5, kSmallest = 1e-12;

}  // namespace

PowerReport TallPower::operator()(TallColumns& a,
                                  const Power& power,
                                  VectorOut<double> update) {
  const Index n = update.size();
  SUITE_CHECK(a.columns() == n + 1,
              "the matrix must have the columns of J and g");
  top_.resize(n, n + 1);
  triangularize(a, n, top_);
  return of_triangle(top_, power, update);
}

PowerReport TallPower::of_triangle(BatchIn<double> r,
                                   const Power& power,
                                   VectorOut<double> update) {
  const Index n = update.size();
  PowerReport report;
  update.setZero();
  spared_ = abandoned_ = false;
  if (!r.allFinite()) {
    report.ending = Ending::nonfinite;
    return report;
  }
  h_ = r.col(n);
  const double largest = r.leftCols(n).cwiseAbs().maxCoeff();
  if (largest == 0 || h_.isZero(0)) {
    report.ending = Ending::zero;
    return report;
  }
  int exponent;
  std::frexp(largest, &exponent);
  scale_ = std::ldexp(1.0, exponent);
  r_ = r.leftCols(n) * std::ldexp(1.0, -exponent);
  spared_ = by_lanes(power, update, report);
  if (spared_) return report;
  ++fallbacks_;
  explicit_.factor(r_ * scale_, h_);
  return explicit_.apply(power, update);
}

bool TallPower::by_lanes(const Power& power,
                         VectorOut<double> update,
                         PowerReport& report) {
  const Index n = h_.size();
  // The longest column is at most s_max.
  const double length = std::sqrt(r_.colwise().squaredNorm().maxCoeff());
  const double cut = power.absolute ? power.tau / scale_ : power.tau * length;
  const double floor = kBelowCut * cut;
  if (!(floor >= kSmallest * length)) return false;
  abandoned_ = true;
  bidiagonal_.reduce(r_, h_);
  if (!lanes_.find(bidiagonal_.diagonal(), bidiagonal_.below(), floor))
    return false;
  const Index found = lanes_.count();
  if (found == 0 || found > n) return false;
  abandoned_ = false;

  spectrum_.lambda.resize(n), spectrum_.c.resize(n), weights_.resize(n);
  spectrum_.scale = scale_;
  double left = h_.squaredNorm();
  const double first = bidiagonal_.alpha() * bidiagonal_.diagonal()(0);
  for (Index i = 0; i < found; ++i) {
    spectrum_.lambda(i) = lanes_.lambda(i);
    spectrum_.c(i) = first * lanes_.first(i) / std::sqrt(lanes_.lambda(i));
    left -= spectrum_.c(i) * spectrum_.c(i);
  }
  // Of the others it is known how small they are, and what is left of h.
  const auto others = static_cast<double>(n - found);
  for (Index i = found; i < n; ++i) {
    spectrum_.lambda(i) = floor * floor;
    spectrum_.c(i) = std::sqrt(std::max(left, 0.0) / others);
  }
  // Two reductions: J to R, and R to two diagonals.
  spectrum_.noise = {.slope = 2 * entry_noise(n, 0),
                     .tail_begin = 0,
                     .norm_factor = norm_factor(n)};
  report = power_weights(spectrum_, power, weights_);
  for (Index i = 0; i < found; ++i) weights_(i) *= spectrum_.s(i);
  lanes_.combine(weights_.head(found), update);
  bidiagonal_.apply(update);
  return true;
}

std::size_t TallPower::bytes() const {
  return static_cast<std::size_t>(4 * r_.size()) * sizeof(double);
}

}  // namespace physinv::hig
