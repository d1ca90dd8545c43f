/// Where a long stage saves its state, to be restored by another process.
#pragma once

#include <optional>

#include "suite/core/archive.h"

namespace physinv {

class Checkpoint {
 public:
  virtual ~Checkpoint() = default;
  /// What was saved last, nothing if there is none.
  virtual std::optional<Archive> last() = 0;
  /// Is it time? When does not matter to any result.
  virtual bool due() = 0;
  virtual void save(Index iteration, const Archive& state) = 0;
};

}  // namespace physinv
