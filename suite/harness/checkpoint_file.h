/// Checkpoints of a worker: states in files (suite/store/stage_state.h).
#pragma once

#include <filesystem>

#include "suite/core/checkpoint.h"
#include "suite/store/record.h"
#include "suite/store/thread_log.h"

namespace physinv {

/// Whether a stage is to end where it saves its state.
enum class Leaving {
  no,
  if_saved,  ///< to continue elsewhere
  now        ///< even if the state cannot be saved
};

struct CheckpointOptions {
  std::filesystem::path store;  ///< empty: no checkpoints
  double seconds = 0;           ///< between two of a stage
  /// Other than `no`: a stage saves its state as soon as it can, and ends
  /// there.
  Leaving (*leaving)() = nullptr;

  Leaving asked() const { return leaving == nullptr ? Leaving::no : leaving(); }
};

/// A stage was left where it saved its state, or before it began.
struct StageLeft {};

class CheckpointFile final : public Checkpoint {
 public:
  /// Of the stage whose record this will be, in so many threads.
  CheckpointFile(const CheckpointOptions& options,
                 const StageRecord& stage,
                 int threads);

  /// What is damaged is removed: the stage starts again.
  std::optional<Archive> last() override;
  /// Has the stage continued from a state?
  bool restored() const { return restored_; }
  /// The stage cannot continue from there.
  void drop();
  bool due() override;
  /// Since the stage began, in all processes that ran it.
  const ThreadLog& threads() const { return log_; }
  /// A disk that is full costs the checkpoint, not the stage. Throws StageLeft
  /// where the stage is to be left.
  void save(Index iteration, const Archive& state) override;

 private:
  const CheckpointOptions& options_;
  const StageRecord& stage_;
  int threads_;
  double last_;
  ThreadLog log_;
  bool restored_ = false, dropped_ = false, fails_ = false;
};

}  // namespace physinv
