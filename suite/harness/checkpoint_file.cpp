#include "suite/harness/checkpoint_file.h"

#include <limits>
#include <utility>

#include "suite/core/clock.h"
#include "suite/store/errors.h"
#include "suite/store/stage_state.h"

namespace physinv {

CheckpointFile::CheckpointFile(const CheckpointOptions& options,
                               const StageRecord& stage)
    : store_(options.store),
      seconds_(options.seconds),
      last_(now().wall),
      leaving_(options.leaving),
      stage_(stage) {}

std::optional<Archive> CheckpointFile::last() {
  if (dropped_) return {};
  try {
    auto state = read_state(store_, stage_.key);
    if (!state) return {};
    restored_ = true;
    return Archive(std::move(state->bytes));
  } catch (const StoreError&) {
    drop();
    return {};
  }
}

void CheckpointFile::drop() {
  restored_ = false;
  dropped_ = true;
  try {
    remove_state(store_, stage_.key);
  } catch (const StoreError&) {  // the campaign says so when it ends
  }
}

bool CheckpointFile::due() {
  return leaving() || now().wall - last_ >= seconds_;
}

void CheckpointFile::save(Index iteration, const Archive& state) {
  try {
    write_state(store_,
                stage_.key,
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
