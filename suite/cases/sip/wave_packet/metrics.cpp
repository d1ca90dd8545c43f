#include "suite/cases/sip/wave_packet/metrics.h"

#include <algorithm>

#include "suite/core/median.h"
#include "suite/core/oracle.h"

namespace physinv::sip_wave_packet {
namespace {

void evaluate(const Snapshot& s, VectorOut<double> values) {
  Vector<double> error =
      (s.x - s.oracle.data().x).row(0).transpose().cwiseAbs();
  const auto n = static_cast<double>(error.size());
  double sum = 0;
  for (Index i = 0; i < error.size(); ++i) sum += error(i);
  std::sort(error.begin(), error.end());
  const auto share = [&](double within) {
    const auto end = std::lower_bound(error.begin(), error.end(), within);
    return static_cast<double>(end - error.begin()) / n;
  };
  values << sum / n, median_high({error.begin(), error.end()}), share(2),
      share(kBasin);
}

}  // namespace

Metrics metrics() {
  return {.name = "wave_packet",
          .rows = {"mean_error", "median_error", "within_2", "in_basin"},
          .evaluate = evaluate};
}

}  // namespace physinv::sip_wave_packet
