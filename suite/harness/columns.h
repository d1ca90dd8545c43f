/// Tables of a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace physinv {

/// Words in aligned columns. Where they do not fit, the widest columns give way
/// first; no line is longer than the room.
class Columns {
 public:
  /// Heads; those that begin with '<' are at the left of their column, the
  /// others at the right.
  explicit Columns(std::vector<std::string> heads);
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  std::string text(std::size_t room) const;

 private:
  std::vector<bool> left_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace physinv
