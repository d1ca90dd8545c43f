#include "suite/core/disturbance.h"

#include <cmath>
#include <limits>

namespace physinv {
namespace {

std::optional<Precision> disturbance;

template <class T>
double next(double value) {
  const T here = static_cast<T>(value);
  const T far = std::copysign(std::numeric_limits<T>::infinity(), here);
  return here == T(0) ? value : static_cast<double>(std::nextafter(here, far));
}

}  // namespace

void disturb_data(std::optional<Precision> precision) {
  disturbance = precision;
}

Samples<double> disturbed(Samples<double> drawn) {
  if (!disturbance) return drawn;
  const auto move = *disturbance == Precision::f32 ? next<float> : next<double>;
  for (Batch<double>* all : {&drawn.x, &drawn.y, &drawn.given})
    *all = all->unaryExpr(move);
  return drawn;
}

}  // namespace physinv
