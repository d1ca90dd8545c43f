/// Numbers in the text of a cause, in braces:
///
///   {"Adam / HIG"}                    what a condition of the claim measured
///   {percent "share of ends"}         the same, times 100
///   {runs "Adam / HIG"}               the runs or seeds behind it
///   {median("adam", loss_after(20))}  an expression, perhaps `of stages`
///   {printed(55.9, "Table 4")}        the paper's, with its place
///   {printed("half", "Sec. 5")}       in the paper's words
///   {printed("table4/n=4")}           the paper's, by its name in its file
///   {setting("b = 32")}               a setting that sentence, note or labels
///                                     of the claim name with these words
///   {setting("20, 10", "studies/a")}  one that labels of a study name
///
/// They are written with three digits, counts with all: 57.9, 1,360, 5.2e-6;
/// one that was not run as "(not run)". Other numbers (bare_numbers.h) are
/// errors.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "suite/evidence/condition.h"

namespace physinv {

class ClaimNames;
struct PlacedText;

struct CauseNumber {
  enum class Kind { evidence, printed, setting, count };
  std::size_t begin, end;  ///< of the braces in the text
  Kind kind;
  /// Of a condition of the claim; empty: `number`, or `text` as it is.
  std::string label = {};
  std::optional<Condition> number = {};
  std::string text = {};
  std::string of = {};  ///< place in the paper; experiment of a setting
  bool percent = false;
};

/// Throws ExpressionError.
std::vector<CauseNumber> numbers_of(const PlacedText& text,
                                    const ClaimNames& names);

/// The text with its numbers; `measured` gives those of a label or expression.
std::string with_numbers(
    const std::string& text,
    const std::vector<CauseNumber>& numbers,
    const std::function<ConditionResult(const CauseNumber&)>& measured);

}  // namespace physinv
