/// Where a program writes to.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string_view>

namespace physinv {

/// How to write: decided once from the stream and the environment (TERM, CI,
/// NO_COLOR, COLUMNS).
struct Screen {
  std::FILE* stream = stdout;
  bool live = false, color = false;
  bool terminal = false;
  bool quiet = false;  ///< nothing while a campaign runs
  int columns = 80;

  /// Of a table's lines: other outputs than terminals take all of them.
  std::size_t room() const {
    return terminal ? static_cast<std::size_t>(columns)
                    : std::string_view::npos;
  }
  static Screen of(std::FILE* stream);
};

}  // namespace physinv
