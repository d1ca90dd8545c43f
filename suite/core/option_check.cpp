#include "suite/core/option_check.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "suite/core/check.h"

namespace physinv {
namespace {

template <class T>
void check_number(const NamedNumber& number) {
  using Limits = std::numeric_limits<T>;
  const auto [name, value] = number;
  if (!std::isfinite(value))
    throw ContractError(
        fmt::format("{} is {}; it must be a finite number", name, value));
  const double size = std::abs(value);
  if (size > double(Limits::max()) ||
      (size != 0 && size < double(Limits::denorm_min())))
    throw ContractError(
        fmt::format("{} = {} is outside the range of {}: give 0 or a size from "
                    "{} to {}, or run it in double",
                    name,
                    value,
                    std::is_same_v<T, float> ? "float" : "double",
                    Limits::denorm_min(),
                    Limits::max()));
}

}  // namespace

template <class T>
void check_numbers(std::initializer_list<NamedNumber> numbers) {
  for (const NamedNumber& number : numbers) check_number<T>(number);
}

template <class T>
void check_numbers(std::string_view name, const std::vector<double>& values) {
  for (const double value : values) check_number<T>({name, value});
}

template void check_numbers<float>(std::initializer_list<NamedNumber>);
template void check_numbers<double>(std::initializer_list<NamedNumber>);
template void check_numbers<float>(std::string_view,
                                   const std::vector<double>&);
template void check_numbers<double>(std::string_view,
                                    const std::vector<double>&);

}  // namespace physinv
