#include "suite/evidence/shares.h"

#include <cmath>

#include "suite/core/check.h"

namespace physinv {
namespace {

bool are_equal(double a, double b, Equality equality) {
  if (a == b || (a < equality.both_below && b < equality.both_below))
    return true;
  return std::isfinite(b) && std::abs(a - b) <= equality.relative * std::abs(b);
}

}  // namespace

Shares compare_losses(VectorIn<double> loss,
                      VectorIn<double> other,
                      Equality equality) {
  SUITE_CHECK(loss.size() == other.size() && loss.size() > 0,
              "losses must be of the same problems");
  Index better = 0, equal = 0;
  for (Index i = 0; i < loss.size(); ++i) {
    if (!std::isfinite(loss[i])) continue;
    if (are_equal(loss[i], other[i], equality)) {
      ++equal;
    } else if (!(loss[i] >= other[i])) {  // also where the other has NaN
      ++better;
    }
  }
  const auto count = static_cast<double>(loss.size());
  return {static_cast<double>(better) / count,
          static_cast<double>(equal) / count,
          static_cast<double>(loss.size() - better - equal) / count};
}

}  // namespace physinv
