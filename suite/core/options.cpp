#include "suite/core/options.h"

#include <fmt/format.h>

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
    line += '=';
    line += text;
  }
  return line;
}

std::string with_commas(const std::vector<std::string>& texts) {
  std::string line;
  for (const auto& text : texts) {
    if (&text != &texts.front()) line += ',';
    line += text;
  }
  return line;
}

std::string text_of(double number) { return fmt::format("{}", number); }

}  // namespace physinv
