#include "tests/support/tolerance.h"

#include <algorithm>
#include <cmath>

namespace physinv::test {

testing::AssertionResult Comparator::compare(const Batch<double>& a,
                                             const Batch<double>& b) const {
  if (a.rows() != b.rows() || a.cols() != b.cols()) {
    return testing::AssertionFailure()
           << "shape " << a.rows() << "x" << a.cols() << ", expected "
           << b.rows() << "x" << b.cols();
  }
  double largest = 0;
  for (Index j = 0; j < b.cols(); ++j)
    for (Index i = 0; i < b.rows(); ++i)
      if (std::isfinite(b(i, j)))
        largest = std::max(largest, std::abs(b(i, j)));
  const double allowed = atol_ + rtol_ * largest;
  for (Index j = 0; j < b.cols(); ++j)
    for (Index i = 0; i < b.rows(); ++i) {
      const double u = a(i, j), v = b(i, j);
      if (u == v || (std::isnan(u) && std::isnan(v))) continue;
      if (std::abs(u - v) <= allowed && std::isfinite(v)) continue;
      return testing::AssertionFailure()
             << "(" << i << ", " << j << "): " << u << ", expected " << v
             << ", off by " << std::abs(u - v) << ", allowed " << allowed;
    }
  return testing::AssertionSuccess();
}

testing::AssertionResult Comparator::operator()(double a, double b) const {
  return compare(Batch<double>::Constant(1, 1, a),
                 Batch<double>::Constant(1, 1, b));
}

}  // namespace physinv::test
