#include "optimizers/steps/clip_percentile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace physinv {
namespace {

/// Two-norm; squares that overflow or vanish are summed again, scaled.
template <class T>
double norm(const T* g, Index d) {
  double sum = 0, largest = 0;
  bool finite = true;
  for (Index j = 0; j < d; ++j) {
    const auto v = static_cast<double>(g[j]);
    finite &= std::isfinite(v);
    largest = std::max(largest, std::abs(v));
    sum = std::fma(v, v, sum);
  }
  if (!finite) return std::numeric_limits<double>::quiet_NaN();
  if (std::isfinite(sum) && sum > 1e-280) return std::sqrt(sum);
  if (largest == 0) return 0;
  sum = 0;
  for (Index j = 0; j < d; ++j) {
    const double v = static_cast<double>(g[j]) / largest;
    sum = std::fma(v, v, sum);
  }
  return largest * std::sqrt(sum);
}

/// Linear interpolation between order statistics; reorders `values`.
double percentile(std::vector<double>& values, double quantile) {
  if (values.empty()) return 0;
  const double position = quantile * static_cast<double>(values.size() - 1);
  const double below = std::floor(position);
  const auto lo = values.begin() + static_cast<std::ptrdiff_t>(below);
  std::nth_element(values.begin(), lo, values.end());
  if (position == below) return *lo;
  const double next = *std::min_element(lo + 1, values.end());
  return *lo + (position - below) * (next - *lo);
}

}  // namespace

template <class T>
double ClipPercentile::operator()(BatchOut<T> gradient) {
  const Index d = gradient.rows(), n = gradient.cols();
  norms_.resize(static_cast<std::size_t>(n));
  finite_.clear();
  finite_.reserve(norms_.size());
  for (Index i = 0; i < n; ++i) {
    const double r = norm(gradient.col(i).data(), d);
    norms_[static_cast<std::size_t>(i)] = r;
    if (std::isfinite(r)) finite_.push_back(r);
  }
  const double tau = percentile(finite_, quantile_);
  for (Index i = 0; i < n; ++i) {
    const double r = norms_[static_cast<std::size_t>(i)];
    if (!std::isfinite(r)) {
      gradient.col(i).setZero();
    } else if (r > tau) {
      for (Index j = 0; j < d; ++j)  // tau / r alone may underflow
        gradient(j, i) = static_cast<T>(tau * (gradient(j, i) / r));
    }
  }
  return tau;
}

template double ClipPercentile::operator()<float>(BatchOut<float>);
template double ClipPercentile::operator()<double>(BatchOut<double>);

}  // namespace physinv
