#include "suite/results/shortened.h"

#include <algorithm>

namespace physinv {
namespace {

bool begins(char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }

/// Where its character of this number begins.
std::size_t offset_of(std::string_view text, std::size_t character) {
  std::size_t at = 0;
  for (; at < text.size(); ++at)
    if (begins(text[at]) && character-- == 0) break;
  return at;
}

}  // namespace

std::string shortened(std::string_view text, std::size_t width) {
  const auto have =
      static_cast<std::size_t>(std::count_if(text.begin(), text.end(), begins));
  if (have <= width) return std::string(text);
  if (width == 0) return "";
  const std::size_t tail = (width - 1) / 2, head = width - 1 - tail;
  std::string out(text.substr(0, offset_of(text, head)));
  out += "…";
  return out.append(text.substr(offset_of(text, have - tail)));
}

}  // namespace physinv
