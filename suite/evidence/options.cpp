#include "suite/evidence/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "suite/store/errors.h"

namespace physinv {

std::optional<double> number_of(const Options& options, std::string_view name) {
  const auto found =
      std::find_if(options.begin(), options.end(), [&](const auto& option) {
        return option.first == name;
      });
  if (found == options.end()) return {};
  const std::string& text = found->second;
  double number = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size())
    throw UnreadableInput(fmt::format(
        "option '{}' of a stage is '{}'; expected a number", name, text));
  return number;
}

}  // namespace physinv
