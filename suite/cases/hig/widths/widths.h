/// Networks of several widths on the oscillators, for the cost of an update.
#pragma once

#include <fmt/format.h>

#include <array>
#include <string>

#include "suite/core/batch.h"

namespace physinv::hig::widths {

inline constexpr std::array<Index, 6> kWidths{20, 40, 80, 160, 320, 640};

inline std::string name_of(Index width) {
  return fmt::format("hig/oscillators-width{}", width);
}

}  // namespace physinv::hig::widths
