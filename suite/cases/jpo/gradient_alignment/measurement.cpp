#include "suite/cases/jpo/gradient_alignment/measurement.h"

#include <utility>

#include "problems/noisy_absolute/noise_lanes.h"
#include "suite/diagnostics/alignment.h"

namespace physinv::alignment {

std::shared_ptr<const Stage> measurement(const NoisyAbsoluteOptions& data,
                                         std::optional<TinyNetOptions> network,
                                         Index repetitions,
                                         std::optional<double> clip) {
  return std::make_shared<MeasureAlignment<NoiseLanes>>(
      AlignmentOptions<NoiseLanes>{.data = data,
                                   .network = std::move(network),
                                   .repetitions = repetitions,
                                   .clip = clip});
}

}  // namespace physinv::alignment
