#include "reports/text.h"

#include <fmt/format.h>

#include <cmath>

#include "suite/core/power_of_ten.h"

namespace physinv {

std::size_t display_width(std::string_view text) {
  std::size_t width = 0;
  for (const char c : text) {
    width += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }
  return width;
}

std::string pad_left(std::string_view text, std::size_t width) {
  const std::size_t have = display_width(text);
  std::string out(have < width ? width - have : 0, ' ');
  return out.append(text);
}

std::string pad_right(std::string_view text, std::size_t width) {
  std::string out(text);
  const std::size_t have = display_width(text);
  return out.append(have < width ? width - have : 0, ' ');
}

std::vector<std::string> wrap(std::string_view text, std::size_t width) {
  std::vector<std::string> lines;
  std::string line;
  while (!text.empty()) {
    const std::size_t space = text.find_first_of(" \n");
    const std::string_view word = text.substr(0, space);
    text.remove_prefix(space == text.npos ? text.size() : space + 1);
    if (word.empty()) continue;
    if (!line.empty() &&
        display_width(line) + 1 + display_width(word) > width) {
      lines.push_back(std::move(line));
      line.clear();
    }
    if (!line.empty()) line += ' ';
    line += word;
  }
  if (!line.empty()) lines.push_back(std::move(line));
  return lines;
}

std::string show_number(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  const double size = std::abs(value);
  const bool vanishes = size != 0 && size < 0.5 * math::power_of_ten(-digits);
  if (vanishes || size >= 1e7) return fmt::format("{:.1e}", value);
  const std::string text = fmt::format("{:.{}f}", value, digits);
  return value == 0 && text.front() == '-' ? text.substr(1) : text;
}

std::string superscript(int exponent) {
  static constexpr const char* kDigits[] = {
      "⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out;
  for (const char c : std::to_string(exponent)) {
    out += c == '-' ? "⁻" : kDigits[c - '0'];
  }
  return out;
}

}  // namespace physinv
