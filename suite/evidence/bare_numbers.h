/// Numbers in the text of a cause that say nothing of where they come from.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace physinv {

struct BareNumber {
  std::size_t begin;  ///< of its first letter or figure
  std::string text;
};

/// Words outside braces that begin with a digit, also behind a sign, a bracket
/// or a relation, and two to twelve, twenty, hundred, thousand, twice, half and
/// other fractions in words; but for places in a paper: what follows Table,
/// Fig., Sec., App. or Theorem, and lists behind Tables, Figs., Secs. or Apps.
std::vector<BareNumber> bare_numbers(std::string_view text);

}  // namespace physinv
