#include "suite/evidence/claim_expression.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <exception>
#include <vector>

#include "suite/core/decimal.h"
#include "suite/evidence/training.h"
#include "suite/results/nearest.h"

namespace physinv {
namespace {

using Place = PlacedText::Place;

constexpr int kDeepest = 50;  ///< parentheses, calls of defined functions
constexpr std::size_t kLongestText = 1000;  ///< of parts that are joined

std::string kind_of_value(const ClaimValue& v) { return kind_of(v.type()); }

/// Of text and of numbers, as parts of names have them: "-b" + 8.
std::optional<std::string> written(const ClaimValue& value) {
  if (const auto* number = std::any_cast<double>(&value))
    return fmt::format("{}", *number);
  return claim_value_as<std::string>(value);
}

/// left sign right.
ClaimValue combined(const Token& sign,
                    const ClaimValue& left,
                    const ClaimValue& right) {
  const char s = sign.text.front();
  const auto *a = std::any_cast<double>(&left),
             *b = std::any_cast<double>(&right);
  if (a != nullptr && b != nullptr)
    return s == '+'   ? *a + *b
           : s == '-' ? *a - *b
           : s == '*' ? *a * *b
                      : *a / *b;
  if (const auto* text = std::any_cast<std::string>(&left);
      s == '+' && text != nullptr)
    if (const auto end = written(right)) {
      if (text->size() + end->size() > kLongestText)
        throw ExpressionError{sign.place, "this text is too long"};
      return *text + *end;
    }
  const auto *of = std::any_cast<RunValue>(&left),
             *under = std::any_cast<RunValue>(&right);
  if (s == '/' && of != nullptr && under != nullptr) return over(*of, *under);
  const auto q = claim_value_as<Quantity>(left),
             r = claim_value_as<Quantity>(right);
  if (q && r && s == '/') return ratio(*q, *r);
  if (q && r && s == '-') return difference(*q, *r);
  if (r && s == '*' && a != nullptr) return times(*a, *r);
  throw ExpressionError{sign.place,
                        fmt::format("{} {} {} has no meaning",
                                    kind_of_value(left),
                                    sign.text,
                                    kind_of_value(right))};
}

}  // namespace

// ---- tokens -----------------------------------------------------------------

bool Expression::is(std::string_view text) const {
  return now().kind != Token::Kind::text && now().text == text;
}
bool Expression::take_if(std::string_view text) {
  if (!is(text)) return false;
  ++next_;
  return true;
}
void Expression::expect(std::string_view text) {
  if (!take_if(text)) fail(fmt::format("'{}' is missing here", text));
}
void Expression::expect_end() const {
  if (now().kind != Token::Kind::end)
    fail(fmt::format("'{}' is not expected here", now().text));
}
Tokens Expression::rest() const {
  return {tokens_.begin() + static_cast<std::ptrdiff_t>(next_), tokens_.end()};
}

// ---- errors -----------------------------------------------------------------

void Expression::fail(std::string what) const {
  throw ExpressionError{now().place, std::move(what)};
}
void Expression::needed(std::type_index type,
                        const ClaimValue& given,
                        const Place& place) {
  throw ExpressionError{
      place,
      fmt::format(
          "this is {}, {} is needed", kind_of_value(given), kind_of(type))};
}
void Expression::unknown(const Token& t) const {
  const std::string near = nearest_word(names_.all(), t.text);
  throw ExpressionError{
      t.place,
      fmt::format("there is no '{}'{}",
                  t.text,
                  near.empty() ? "" : fmt::format("; did you mean {}?", near))};
}

// ---- values -----------------------------------------------------------------

ClaimValue Expression::sum() {
  ClaimValue left = product();
  while (is("+") || is("-")) {
    const Token sign = take();
    left = combined(sign, left, product());
  }
  return left;
}

ClaimValue Expression::product() {
  ClaimValue left = factor();
  while (is("*") || is("/")) {
    const Token sign = take();
    left = combined(sign, left, factor());
  }
  return left;
}

ClaimValue Expression::factor() {
  const Token t = now();
  if (depth_ > kDeepest) fail("this is nested too deeply");
  if (t.kind == Token::Kind::end) fail("an expression is missing here");
  ++next_;
  if (t.kind == Token::Kind::number) {
    if (const auto number = decimal<double>(t.text)) return *number;
    throw ExpressionError{t.place, t.text + " is outside the range of numbers"};
  }
  if (t.kind == Token::Kind::text) return t.text;
  if (t.kind == Token::Kind::name) return is("(") ? call(t) : value(t);
  if (t.text == "-") {
    ++depth_;
    const double negative = -as<double>(factor(), now().place);
    --depth_;
    return negative;
  }
  if (t.text == "(") {
    ++depth_;
    ClaimValue inner = sum();
    --depth_;
    expect(")");
    return inner;
  }
  if (t.text == "[") return list("]");
  throw ExpressionError{t.place,
                        fmt::format("'{}' is not expected here", t.text)};
}

ClaimList Expression::list(std::string_view close) {
  ClaimList all;
  ++depth_;
  while (!is(close)) {
    if (!all.empty()) expect(",");
    all.push_back(sum());
  }
  --depth_;
  expect(close);
  return all;
}

ClaimValue Expression::value(const Token& t) const {
  if (const auto local = locals_.find(t.text); local != locals_.end())
    return local->second;
  if (const ClaimValue* found = names_.value(t.text)) return *found;
  if (names_.functions(t.text) != nullptr)
    throw ExpressionError{t.place,
                          t.text + " is a function and takes arguments"};
  unknown(t);
}

ClaimValue Expression::call(const Token& t) {
  ++next_;
  const ClaimList arguments = list(")");
  const auto* functions = names_.functions(t.text);
  if (functions == nullptr) unknown(t);
  if (--calls_left_ < 0)
    throw ExpressionError{t.place, "this makes too many calls"};
  std::vector<std::string> forms;
  for (const ClaimNames::Function& f : *functions) {
    if (f.parameters.size() == arguments.size())
      if (auto result = result_of_call(f, arguments, t))
        return std::move(*result);
    std::vector<std::string> kinds;
    for (const auto& p : f.parameters) kinds.push_back(kind_of(p));
    forms.push_back(fmt::format("({})", fmt::join(kinds, ", ")));
  }
  std::vector<std::string> given;
  for (const ClaimValue& v : arguments) given.push_back(kind_of_value(v));
  throw ExpressionError{t.place,
                        fmt::format("{} takes {}, not ({})",
                                    t.text,
                                    fmt::join(forms, " or "),
                                    fmt::join(given, ", "))};
}

/// Errors of the function are reported at the place of the call.
std::optional<ClaimValue> Expression::result_of_call(
    const ClaimNames::Function& f,
    const ClaimList& arguments,
    const Token& t) const {
  try {
    return f.call({arguments, names_, depth_ + 1, calls_left_});
  } catch (const std::exception& error) {
    throw ExpressionError{t.place, error.what()};
  }
}

}  // namespace physinv
