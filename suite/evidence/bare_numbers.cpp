#include "suite/evidence/bare_numbers.h"

#include <algorithm>
#include <array>
#include <utility>

#include "suite/evidence/claim_tokens.h"

namespace physinv {
namespace {

/// A word without what precedes its first letter or figure.
std::string_view without_signs(std::string_view word) {
  const auto is_sign = [](char c) {
    return !is_digit(c) && !(c >= 'a' && c <= 'z') && !(c >= 'A' && c <= 'Z');
  };
  const auto first = std::find_if_not(word.begin(), word.end(), is_sign);
  word.remove_prefix(static_cast<std::size_t>(first - word.begin()));
  return word;
}

/// The word has no signs before it.
bool is_number(std::string_view word) {
  constexpr std::array<std::string_view, 26> words{
      "two",   "three",   "four",   "five",   "six",     "seven",    "eight",
      "nine",  "ten",     "eleven", "twelve", "twenty",  "hundred",  "thousand",
      "twice", "half",    "third",  "thirds", "quarter", "quarters", "fifth",
      "sixth", "seventh", "eighth", "ninth",  "tenth"};
  if (word.empty() || is_digit(word.front())) return !word.empty();
  word = word.substr(0, word.find_first_of(",;:.)%-"));
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Reads a text word by word: "Table 4", "Tables 4, 5 and 6", "Secs. 2 to 3".
class PlacesInPaper {
 public:
  /// Is the word, which has no signs before it, the number of a place?
  bool take(std::string_view word) {
    constexpr std::array<std::string_view, 5> one{
        "Table", "Fig.", "Sec.", "App.", "Theorem"};
    constexpr std::array<std::string_view, 4> some{
        "Tables", "Figs.", "Secs.", "Apps."};
    const auto is_in = [&](const auto& words) {
      return std::find(words.begin(), words.end(), word) != words.end();
    };
    const State before = std::exchange(state_, State::elsewhere);
    const bool joins = word == "and" || word == "to";
    if (is_in(one)) state_ = State::before_one;
    if (is_in(some) || (before == State::behind_some && joins))
      state_ = State::before_some;
    if (word.empty() || !is_digit(word.front())) return false;
    if (before == State::before_some && word.ends_with(','))
      state_ = State::before_some;
    else if (before == State::before_some &&
             std::string_view(".;:)").find(word.back()) == word.npos)
      state_ = State::behind_some;
    return before == State::before_one || before == State::before_some;
  }

 private:
  enum class State { elsewhere, before_one, before_some, behind_some };
  State state_ = State::elsewhere;
};

}  // namespace

std::vector<BareNumber> bare_numbers(std::string_view text) {
  std::vector<BareNumber> bare;
  PlacesInPaper places;
  int depth = 0;
  for (std::size_t at = 0; at < text.size();) {
    const auto end = std::min(text.find_first_of(" =<>/", at), text.size());
    const std::string_view whole = text.substr(at, end - at);
    at = end + 1;
    const bool inside = depth > 0 || whole.find('{') != whole.npos;
    for (const char c : whole) depth += (c == '{') - (c == '}');
    const std::string_view word = inside ? "" : without_signs(whole);
    if (!places.take(word) && is_number(word))
      bare.push_back({end - word.size(), std::string(word)});
  }
  return bare;
}

}  // namespace physinv
