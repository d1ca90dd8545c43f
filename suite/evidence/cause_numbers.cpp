#include "suite/evidence/cause_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "suite/core/decimal.h"
#include "suite/evidence/bare_numbers.h"
#include "suite/evidence/claim_conditions.h"
#include "suite/evidence/claim_tokens.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

/// Reads the inside of braces from left to right.
class Inside {
 public:
  explicit Inside(const PlacedText& code) : code_(code) {}

  bool take(std::string_view part) {
    skip_spaces();
    if (code_.text.compare(at_, part.size(), part) != 0) return false;
    at_ += part.size();
    return true;
  }
  void expect(std::string_view part) {
    if (!take(part)) fail(fmt::format("'{}' is missing here", part));
  }
  bool is(char c) {
    skip_spaces();
    return at_ < code_.text.size() && code_.text[at_] == c;
  }
  bool is_number() {
    skip_spaces();
    return at_ < code_.text.size() && is_digit(code_.text[at_]);
  }
  std::string quoted() {
    expect("\"");
    return until("\"");
  }
  /// What precedes it, and past it.
  std::string until(std::string_view end) {
    const auto found = code_.text.find(end, at_);
    if (found == std::string::npos)
      fail(fmt::format("'{}' is missing after it", end));
    const std::string text = code_.text.substr(at_, found - at_);
    at_ = found + end.size();
    return text;
  }
  void expect_end() {
    skip_spaces();
    if (at_ != code_.text.size())
      fail(fmt::format("'{}' is not expected here", code_.text.substr(at_)));
  }
  [[noreturn]] void fail(std::string what) const {
    throw ExpressionError{code_.place(at_), std::move(what)};
  }

 private:
  void skip_spaces() {
    while (at_ < code_.text.size() && code_.text[at_] == ' ') ++at_;
  }

  const PlacedText& code_;
  std::size_t at_ = 0;
};

/// printed(55.9, "Table 4") or printed("half", "Sec. 5"), false if it is
/// something else.
bool read_printed(const PlacedText& code, CauseNumber& number) {
  Inside in(code);
  if (!in.take("printed(")) return false;
  const bool is_words = in.is('"');
  if (!is_words && !in.is_number()) return false;
  const std::string text = is_words ? in.quoted() : in.until(",");
  if (is_words && !in.take(",")) return false;
  if (!is_words && !decimal<double>(text)) in.fail(text + " is not a number");
  number.kind = CauseNumber::Kind::printed;
  number.text = text;
  number.of = in.quoted();
  if (number.of.empty()) in.fail("the place in the paper is missing");
  in.expect(")");
  in.expect_end();
  return true;
}

/// setting("b = 32") or setting("20, 10", "studies/wall").
bool read_setting(const PlacedText& code, CauseNumber& number) {
  Inside in(code);
  if (!in.take("setting(")) return false;
  number.kind = CauseNumber::Kind::setting;
  number.text = in.quoted();
  if (in.take(",")) number.of = in.quoted();
  in.expect(")");
  in.expect_end();
  return true;
}

/// "label", percent "label" or runs "label".
bool read_label(const PlacedText& code, CauseNumber& number) {
  Inside in(code);
  if (in.take("runs "))
    number.kind = CauseNumber::Kind::count;
  else
    number.percent = in.take("percent ");
  if (!in.is('"')) return false;
  number.label = in.quoted();
  in.expect_end();
  return true;
}

CauseNumber number_of(const PlacedText& code,
                      std::size_t begin,
                      std::size_t end,
                      const ClaimNames& names) {
  CauseNumber number{begin, end, CauseNumber::Kind::evidence};
  if (read_printed(code, number) || read_setting(code, number) ||
      read_label(code, number))
    return number;
  const auto found = conditions_of("", code, names);
  if (found.size() != 1 || !found.front().bounds.empty())
    throw ExpressionError{code.place(0), "braces must contain one number"};
  number.number = found.front();
  const auto& asks = number.number->quantities;
  const bool runs =
      std::any_of(asks.begin(), asks.end(), [](const Quantity& q) {
        return !q.runs().empty();
      });
  const bool printed =
      std::any_of(asks.begin(), asks.end(), [](const Quantity& q) {
        return !q.printed().empty();
      });
  if (!runs && !printed)
    throw ExpressionError{
        code.place(0),
        "this number comes from neither runs nor a paper; use printed(number, "
        "\"place\") or setting(\"text\") to name its source"};
  if (runs && !number.number->of_stages)
    throw ExpressionError{code.place(0),
                          "published campaigns store this number only 'of "
                          "stages'; name a condition by its label for others"};
  if (!runs) number.kind = CauseNumber::Kind::printed;
  return number;
}

/// 1,360 and -12,345.
std::string with_comma(double integer) {
  std::string text = fmt::format("{:.0f}", integer);
  if (std::abs(integer) >= 1000) text.insert(text.size() - 3, ",");
  return text;
}

/// 57.9; 1,360; 5.2e-6: of three digits, counts of all.
std::string in_sentence(double value) {
  const double size = std::abs(value);
  if (!std::isfinite(value)) return "not finite";
  if (size < 1e5 && value == std::round(value)) return with_comma(value);
  if (size >= 1e-3 && size < 999.5) return fmt::format("{:.3g}", value);
  if (size >= 1 && size < 999'500) {
    const double step = size < 1e4 ? 10 : size < 1e5 ? 100 : 1000;
    return with_comma(std::round(value / step) * step);
  }
  const std::string text = fmt::format("{:.2e}", value);
  const auto e = text.find('e');
  return text.substr(0, text.find_last_not_of("0.", e - 1) + 1) +
         (text[e + 1] == '-' ? "e-" : "e") +
         text.substr(text.find_first_not_of("+-0", e + 1));
}

}  // namespace

std::vector<CauseNumber> numbers_of(const PlacedText& text,
                                    const ClaimNames& names) {
  if (const auto bare = bare_numbers(text.text); !bare.empty())
    throw ExpressionError{
        text.place(bare.front().begin),
        fmt::format("the source of '{}' is missing; use {{\"label\"}}, "
                    "{{printed({}, \"place\")}} or {{setting(\"{}\")}}",
                    bare.front().text,
                    bare.front().text,
                    bare.front().text)};
  std::vector<CauseNumber> all;
  for (std::size_t at = 0;;) {
    const auto begin = text.text.find_first_of("{}", at);
    if (begin == std::string::npos) return all;
    const auto end = text.text.find_first_of("{}", begin + 1);
    if (text.text[begin] == '}' || end == std::string::npos ||
        text.text[end] == '{')
      throw ExpressionError{text.place(begin),
                            "braces must contain one number and be closed"};
    at = end + 1;
    all.push_back(number_of(text.part(begin + 1, end), begin, at, names));
  }
}

std::string with_numbers(
    const std::string& text,
    const std::vector<CauseNumber>& numbers,
    const std::function<ConditionResult(const CauseNumber&)>& measured) {
  std::string out;
  std::size_t at = 0;
  for (const CauseNumber& n : numbers) {
    out += text.substr(at, n.begin - at);
    at = n.end;
    if (!n.text.empty()) {
      out += n.text;
      continue;
    }
    const ConditionResult r = measured(n);
    const bool counts = n.kind == CauseNumber::Kind::count;
    out += !r.value ? std::string(kNumberNotRun)
           : counts ? fmt::format("{}", r.runs)
                    : in_sentence(n.percent ? 100 * *r.value : *r.value);
  }
  return out + text.substr(at);
}

}  // namespace physinv
