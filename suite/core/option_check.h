/// Options that are to be numbers, refused with their names.
#pragma once

#include <initializer_list>
#include <string_view>
#include <vector>

#include "suite/core/batch.h"

namespace physinv {

struct NamedNumber {
  std::string_view name;
  double value;
};

/// Throws a ContractError that names the first one that T cannot hold: not a
/// number, infinite, or, rounded to T, infinite or 0.
template <class T>
void check_numbers(std::initializer_list<NamedNumber> numbers);

/// The same of the list called `name`.
template <class T>
void check_numbers(std::string_view name, const std::vector<double>& values);

/// Whether all are above 0.
inline bool all_positive(const std::vector<Index>& counts) {
  for (const Index count : counts)
    if (count <= 0) return false;
  return true;
}

extern template void check_numbers<float>(std::initializer_list<NamedNumber>);
extern template void check_numbers<double>(std::initializer_list<NamedNumber>);
extern template void check_numbers<float>(std::string_view,
                                          const std::vector<double>&);
extern template void check_numbers<double>(std::string_view,
                                           const std::vector<double>&);

}  // namespace physinv
