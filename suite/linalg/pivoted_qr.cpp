#include "suite/linalg/pivoted_qr.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "suite/core/check.h"
#include "suite/linalg/householder.h"

namespace physinv::linalg {
namespace {

double norm(Index n, const double* x) { return std::sqrt(dot(n, x, x)); }

}  // namespace

PivotedQr::PivotedQr(Batch<double> a)
    : v_(std::move(a)),
      r_(Batch<double>::Zero(v_.cols(), v_.cols())),
      tau_(v_.cols()),
      length_(v_.cols()),
      order_(static_cast<std::size_t>(v_.cols())) {
  const Index m = v_.rows(), n = v_.cols();
  SUITE_CHECK(m >= n, "the matrix must have at least as many rows as columns");
  std::iota(order_.begin(), order_.end(), Index{0});
  for (Index j = 0; j < n; ++j) length_(j) = norm(m, v_.col(j).data());
  measured_ = length_;
  for (Index k = 0; k < n; ++k) {
    move_longest_to(k);
    double* v = v_.col(k).data() + k;
    tau_(k) = reflect(m - k, v, r_(k, k));
    for (Index j = k + 1; j < n; ++j) {
      double* x = v_.col(j).data() + k;
      turn(m - k, tau_(k), v, x);
      r_(k, j) = x[0];
      shorten(k, j);
    }
  }
}

void PivotedQr::move_longest_to(Index k) {
  Index longest = k;
  for (Index j = k + 1; j < v_.cols(); ++j)
    if (length_(j) > length_(longest)) longest = j;
  if (longest == k) return;
  v_.col(k).swap(v_.col(longest));
  r_.col(k).head(k).swap(r_.col(longest).head(k));
  std::swap(length_(k), length_(longest));
  std::swap(measured_(k), measured_(longest));
  std::swap(order_[static_cast<std::size_t>(k)],
            order_[static_cast<std::size_t>(longest)]);
}

/// The length of column j without its entry k; measured again where the update
/// has lost half of the digits (LAPACK Working Note 176).
void PivotedQr::shorten(Index k, Index j) {
  if (length_(j) == 0) return;
  const double share = std::abs(r_(k, j)) / length_(j);
  const double left = std::max(0.0, (1 + share) * (1 - share));
  const double since = length_(j) / measured_(j);
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  if (left * since * since > std::sqrt(kEpsilon)) {
    length_(j) *= std::sqrt(left);
    return;
  }
  length_(j) = norm(v_.rows() - k - 1, v_.col(j).data() + k + 1);
  measured_(j) = length_(j);
}

void PivotedQr::apply_q(BatchOut<double> x) const {
  for (Index k = v_.cols() - 1; k >= 0; --k)
    for (Index j = 0; j < x.cols(); ++j)
      turn(v_.rows() - k, tau_(k), v_.col(k).data() + k, x.col(j).data() + k);
}

void PivotedQr::apply_q_transposed(BatchOut<double> x) const {
  for (Index k = 0; k < v_.cols(); ++k)
    for (Index j = 0; j < x.cols(); ++j)
      turn(v_.rows() - k, tau_(k), v_.col(k).data() + k, x.col(j).data() + k);
}

}  // namespace physinv::linalg
