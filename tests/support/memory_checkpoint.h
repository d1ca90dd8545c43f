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
    restored = state.has_value();
    if (!state) return {};
    return Archive(*state);
  }
  bool due() override { return --left_ == 0; }
  void save(Index iteration, const Archive& archive) override {
    at = iteration;
    state = archive.bytes();
  }

  std::optional<std::string> state;
  Index at = 0;
  bool restored = false;

 private:
  Index left_;
};

}  // namespace physinv::test
