#include "suite/core/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace physinv {

Options chained(Options a, const Options& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::string in_line(const Options& options) {
  std::string line;
  for (const auto& [name, text] : options) {
    if (!line.empty()) line += ' ';
    line += name;
    if (!name.empty()) line += '=';
    line += text;
  }
  return line;
}

std::string joined(const std::vector<std::string>& texts,
                   std::string_view separator) {
  return fmt::format("{}", fmt::join(texts, separator));
}

std::string text_of(double number) { return fmt::format("{}", number); }

}  // namespace physinv
