#include "suite/cases/hig_curve.h"

#include <limits>

namespace physinv {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

}  // namespace

double CurveRow::operator()(Index k) const {
  const double value = stage.arrays.at(array)(row, k);
  return value < std::numeric_limits<double>::max() ? value : kInfinite;
}

}  // namespace physinv
