#include "suite/harness/columns.h"

#include <algorithm>
#include <string_view>

#include "suite/results/shortened.h"

namespace physinv {
namespace {

constexpr std::size_t kGap = 2, kNarrowest = 4;

bool begins(char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }

std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), begins));
}

/// Widths that fit: the widest becomes as narrow as the next, and so on.
std::vector<std::size_t> fitted(std::vector<std::size_t> widths,
                                std::size_t room) {
  std::size_t used = kGap * (widths.size() - 1);
  for (const std::size_t width : widths) used += width;
  while (used > room) {
    const auto widest = std::max_element(widths.begin(), widths.end());
    if (*widest <= kNarrowest) break;
    --*widest, --used;
  }
  return widths;
}

}  // namespace

Columns::Columns(std::vector<std::string> heads) {
  for (std::string& head : heads) {
    left_.push_back(head.starts_with('<'));
    if (left_.back()) head.erase(0, 1);
  }
  rows_.push_back(std::move(heads));
}

std::string Columns::text(std::size_t room) const {
  std::vector<std::size_t> widths(left_.size(), 0);
  for (const auto& row : rows_)
    for (std::size_t c = 0; c < row.size(); ++c)
      widths[c] = std::max(widths[c], width_of(row[c]));
  widths = fitted(std::move(widths), room);
  std::string out;
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string word = shortened(row[c], widths[c]);
      const std::string space(widths[c] - width_of(word), ' ');
      line += (c > 0 ? std::string(kGap, ' ') : "") +
              (left_[c] ? word + space : space + word);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += shortened(line, room) + '\n';
  }
  return out;
}

}  // namespace physinv
