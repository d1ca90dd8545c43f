/// What decides a result, in words.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace physinv {

/// Named options in declared order, as text that round-trips. They enter the
/// record and the content key.
using Options = std::vector<std::pair<std::string, std::string>>;

enum class Precision : std::uint8_t { f32, f64 };

constexpr std::string_view to_string(Precision p) {
  return p == Precision::f32 ? "f32" : "f64";
}

}  // namespace physinv
