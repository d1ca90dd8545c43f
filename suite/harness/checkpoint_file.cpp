#include "suite/harness/checkpoint_file.h"

#include <limits>
#include <utility>

#include "suite/core/clock.h"
#include "suite/results/errors.h"
#include "suite/results/stage_state.h"

namespace physinv {

CheckpointFile::CheckpointFile(const CheckpointOptions& options,
                               const StageRecord& stage)
    : path_(state_path(options.store, stage.key)),
      seconds_(options.seconds),
      last_(now().wall),
      leaving_(options.leaving),
      stage_(stage) {}

std::optional<Archive> CheckpointFile::last() {
  auto state = read_state(path_);
  if (!state) return {};
  return Archive(std::move(state->bytes));
}

bool CheckpointFile::due() {
  return leaving() || now().wall - last_ >= seconds_;
}

void CheckpointFile::lay_down(Index iteration, const Archive& state) {
  try {
    write_state(path_,
                {.case_name = stage_.case_name,
                 .stage = stage_.stage,
                 .iteration = iteration,
                 .bytes = state.bytes()});
  } catch (const StoreError&) {
    seconds_ = std::numeric_limits<double>::infinity();
  }
  if (leaving()) throw StageLeft();
  last_ = now().wall;
}

}  // namespace physinv
