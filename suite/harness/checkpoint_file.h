/// Checkpoints of a worker: states in files (suite/store/stage_state.h).
#pragma once

#include <filesystem>

#include "suite/core/checkpoint.h"
#include "suite/store/record.h"

namespace physinv {

struct CheckpointOptions {
  std::filesystem::path store;  ///< empty: no checkpoints
  double seconds = 0;           ///< between two of a stage
  /// True: a stage saves its state as soon as it can, and ends there.
  bool (*leaving)() = nullptr;
};

/// A stage was left where it saved its state.
struct StageLeft {};

class CheckpointFile final : public Checkpoint {
 public:
  /// Of the stage whose record this will be.
  CheckpointFile(const CheckpointOptions& options, const StageRecord& stage);

  /// What is damaged goes: the stage starts again.
  std::optional<Archive> last() override;
  /// Has the stage gone on from a state?
  bool restored() const { return restored_; }
  /// The stage cannot go on from there.
  void drop();
  bool due() override;
  /// A disk that is full costs the checkpoint, not the stage. Throws StageLeft
  /// where the stage is to be left.
  void save(Index iteration, const Archive& state) override;

 private:
  std::filesystem::path store_;
  double seconds_, last_;
  bool (*leaving_)();
  bool restored_ = false, dropped_ = false;
  const StageRecord& stage_;

  bool leaving() const { return leaving_ != nullptr && leaving_(); }
};

}  // namespace physinv
