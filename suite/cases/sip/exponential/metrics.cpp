#include "suite/cases/sip/exponential/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "suite/core/math.h"
#include "suite/core/oracle.h"

namespace physinv::exponential {
namespace {

struct Mean {
  void operator+=(double v) { sum += v, count += 1; }
  double value() const { return count > 0 ? sum / count : 0; }
  double sum = 0, count = 0;
};

void evaluate(const Snapshot& s, VectorOut<double> values) {
  Mean all;
  std::array<Mean, 3> thirds;
  double largest = 0, from = std::numeric_limits<double>::infinity(),
         to = -from;
  Index lowest = 0, three = 0;
  const Batch<double>& y = s.oracle.observations();
  const auto wanted = [&](Index i) { return math::log(y(0, i)); };
  for (Index i = 0; i < s.x.cols(); ++i) {
    const double x = s.x(0, i), w = wanted(i), error = std::abs(x - w);
    all += error;
    thirds[w < -8 ? 0 : w < -4 ? 1 : 2] += error;
    largest = std::max(largest, error);
    if (w < -9) from = std::min(from, x), to = std::max(to, x);
    if (w < wanted(lowest)) lowest = i;
    if (std::abs(w + 3) < std::abs(wanted(three) + 3)) three = i;
  }
  values << all.value(), thirds[0].value(), thirds[1].value(),
      thirds[2].value(), largest, from <= to ? to - from : 0,
      s.x(0, three) - s.x(0, lowest);
}

}  // namespace

Metrics metrics() {
  return {
      .name = "exponential",
      .rows = {"mean", "low", "middle", "high", "largest", "spread", "rise"},
      .evaluate = evaluate};
}

}  // namespace physinv::exponential
