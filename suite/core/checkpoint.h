/// Where a long stage lays its state down, to be taken up by another process.
#pragma once

#include <optional>

#include "suite/core/archive.h"

namespace physinv {

class Checkpoint {
 public:
  virtual ~Checkpoint() = default;
  /// What was laid down last, nothing if there is none.
  virtual std::optional<Archive> last() = 0;
  /// Is it time? When does not matter to any result.
  virtual bool due() = 0;
  virtual void lay_down(Index iteration, const Archive& state) = 0;
};

}  // namespace physinv
