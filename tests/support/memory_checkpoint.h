/// A checkpoint that keeps the state after one update in memory.
#pragma once

#include <optional>
#include <string>

#include "suite/core/checkpoint.h"

namespace physinv::test {

class MemoryCheckpoint final : public Checkpoint {
 public:
  /// After `update` updates, counted by how often it is asked.
  explicit MemoryCheckpoint(Index update) : left_(update) {}

  std::optional<Archive> last() override {
    taken_up = state.has_value();
    if (!state) return {};
    return Archive(*state);
  }
  bool due() override { return --left_ == 0; }
  void lay_down(Index iteration, const Archive& archive) override {
    at = iteration;
    state = archive.bytes();
  }

  std::optional<std::string> state;
  Index at = 0;
  bool taken_up = false;

 private:
  Index left_;
};

}  // namespace physinv::test
