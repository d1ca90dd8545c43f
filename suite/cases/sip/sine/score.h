/// The paper's score of a run of the sine.
#pragma once

#include <optional>

#include "suite/cases/sip/sine/sine.h"
#include "suite/evidence/quantity.h"
#include "suite/evidence/training.h"
#include "suite/store/record.h"

namespace physinv::sine {

/// Mean distance to the nearest solution over the batches of the last tenth of
/// the updates; infinite if the run diverged.
inline RunValue score() { return or_infinite(late_training_error()); }

/// Of a study of rates.
inline Quantity score_at_rate(int xi, const char* method, const char* factor) {
  return median(Select{at_rate(method, factor)}.in(rate_study(xi)), score());
}
/// Adam's last loss: distances scale with gamma, losses do not.
inline Quantity loss_of_gamma(int xi, int gamma) {
  return median(Select{"adam"}.in(gamma_study(xi, gamma)), last_loss());
}

/// Of runs of 8000 updates alone.
inline RunValue at_quick(RunValue value) {
  return [value](const Run& run) -> std::optional<double> {
    if (run.stage->iterations != 8000) return {};
    return value(run);
  };
}

}  // namespace physinv::sine
