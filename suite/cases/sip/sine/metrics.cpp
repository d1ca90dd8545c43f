#include "suite/cases/sip/sine/metrics.h"

#include <cmath>

#include "suite/core/math.h"
#include "suite/core/oracle.h"

namespace physinv::sine {
namespace {

double mean_distance(const SinePlaneOptions& options,
                     BatchIn<double> x,
                     BatchIn<double> y) {
  double sum = 0;
  for (Index i = 0; i < x.cols(); ++i) {
    const Pair at = {x(0, i), x(1, i)};
    const Pair there = nearest_solution(options, at, {y(0, i), y(1, i)});
    sum += math::hypot(at[0] - there[0], at[1] - there[1]);
  }
  return sum / static_cast<double>(x.cols());
}

}  // namespace

Metrics metrics(const SinePlaneOptions& options) {
  return {.name = "sine",
          .rows = {"distance"},
          .evaluate = [options](const Snapshot& s, VectorOut<double> values) {
            values(kDistance) =
                mean_distance(options, s.x, s.oracle.observations());
          }};
}

LateError late_distance(const SinePlaneOptions& options) {
  return {.name = "distance",
          .of = [options](BatchIn<double> x, BatchIn<double> y) {
            return mean_distance(options, x, y);
          }};
}

}  // namespace physinv::sine
