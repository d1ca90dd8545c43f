#include "suite/harness/checkpoint_file.h"

#include <utility>

#include "suite/core/clock.h"
#include "suite/store/errors.h"
#include "suite/store/stage_state.h"

namespace physinv {

CheckpointFile::CheckpointFile(const CheckpointOptions& options,
                               const StageRecord& stage,
                               int threads)
    : options_(options),
      stage_(stage),
      threads_(threads),
      last_(now().wall),
      log_{{0, threads}} {}

std::optional<Archive> CheckpointFile::last() {
  if (dropped_) return {};
  try {
    auto state = read_state(options_.store, stage_.key);
    if (!state) return {};
    restored_ = true;
    if (!state->threads.empty()) log_ = std::move(state->threads);
    note_threads(log_, state->iteration, threads_);
    return Archive(std::move(state->bytes));
  } catch (const StoreError&) {
    drop();
    return {};
  }
}

void CheckpointFile::drop() {
  restored_ = false;
  dropped_ = true;
  log_ = {{0, threads_}};
  try {
    remove_state(options_.store, stage_.key);
  } catch (const StoreError&) {  // the campaign says so when it ends
  }
}

bool CheckpointFile::due() {
  const Leaving asked = options_.asked();
  if (asked == Leaving::now) return true;
  return !fails_ &&
         (asked == Leaving::if_saved || now().wall - last_ >= options_.seconds);
}

void CheckpointFile::save(Index iteration, const Archive& state) {
  try {
    write_state(options_.store,
                stage_.key,
                {.case_name = stage_.case_name,
                 .stage = stage_.stage,
                 .iteration = iteration,
                 .bytes = state.bytes(),
                 .threads = log_});
  } catch (const StoreError&) {
    fails_ = true;
  }
  const Leaving asked = options_.asked();
  if (asked == Leaving::now || (asked == Leaving::if_saved && !fails_))
    throw StageLeft();
  last_ = now().wall;
}

}  // namespace physinv
