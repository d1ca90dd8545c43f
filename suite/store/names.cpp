#include "suite/store/names.h"

#include <algorithm>

namespace physinv {
namespace {

/// Of a file's name, the ending ".h5" apart.
constexpr std::size_t kLongestName = 250;
constexpr std::size_t kKeyDigits = 32;

bool all_of(std::string_view text, std::string_view letters) {
  return text.find_first_not_of(letters) == std::string_view::npos;
}

}  // namespace

bool is_word(std::string_view text, std::string_view extra) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || extra.find(c) != std::string_view::npos;
  });
}

bool is_path(std::string_view text, std::string_view extra) {
  for (;;) {
    const auto slash = text.find('/');
    const auto part = text.substr(0, slash);
    if (!is_word(part, extra) || all_of(part, ".")) return false;
    if (slash == std::string_view::npos) return true;
    text.remove_prefix(slash + 1);
  }
}

bool is_case_name(std::string_view text) {
  return text.size() <= kLongestName && is_path(text, "=.+");
}

bool is_key(std::string_view text) {
  return text.size() == kKeyDigits && all_of(text, "0123456789abcdef");
}

}  // namespace physinv
