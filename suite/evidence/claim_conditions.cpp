#include "suite/evidence/claim_conditions.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>
#include <typeindex>
#include <utility>

#include "suite/evidence/claim_expression.h"

namespace physinv {
namespace {

/// "as printed(name, seeds)" or "as stated(value, seeds)".
Condition as_relation(Expression& e, const std::string& label, Quantity q) {
  const Token kind = e.take();
  if (kind.text != "printed" && kind.text != "stated")
    throw ExpressionError{
        kind.place,
        "'as' needs printed(\"name\", seeds) or stated(value, seeds)"};
  e.expect("(");
  if (kind.text == "printed") {
    auto name = e.sum_as<std::string>();
    e.expect(",");
    return as_printed(label, std::move(q), std::move(name), e.sum_as<Index>());
  }
  const auto value = e.sum_as<double>();
  e.expect(",");
  return as_stated(label, std::move(q), value, e.sum_as<Index>());
}

Condition of_relation(Expression& e,
                      const Token& relation,
                      const std::string& label,
                      Quantity q) {
  const std::string& r = relation.text;
  if (r == "as") {
    Condition c = as_relation(e, label, std::move(q));
    e.expect(")");
    return c;
  }
  if (r == ">") return above(label, std::move(q), e.sum_as<Quantity>());
  if (r == "<") return below(label, std::move(q), e.sum_as<Quantity>());
  if (r == ">=") return at_least(label, std::move(q), e.sum_as<Quantity>());
  if (r == "<=") return at_most(label, std::move(q), e.sum_as<Quantity>());
  const auto value = e.sum_as<double>();
  if (r == "near") return near(label, std::move(q), value);
  if (r == "about") return about(label, std::move(q), value);
  if (r == "=")
    return equals(
        label, std::move(q), value, e.take_if("+-") ? e.sum_as<double>() : 0);
  e.expect("..");
  return within(label, std::move(q), value, e.sum_as<double>());
}

constexpr std::string_view kRelations[] = {
    ">", "<", ">=", "<=", "in", "near", "about", "=", "as"};

/// What an expression without a relation says: a number to report, or the
/// conditions that a function made.
std::vector<Condition> without_relation(const Expression& e,
                                        const std::string& label,
                                        const ClaimValue& value,
                                        const PlacedText::Place& place) {
  if (const auto* labelled = std::any_cast<Labelled>(&value))
    return (*labelled)(label);
  if (const auto* one = std::any_cast<Condition>(&value)) return {*one};
  if (const auto all = claim_value_as<std::vector<Condition>>(value)) {
    if (!label.empty())
      throw ExpressionError{
          place,
          "the function has its own labels: remove the label of the line"};
    return *all;
  }
  return {reported(label, e.as<Quantity>(value, place))};
}

std::vector<std::string> parameters_of(Expression& e) {
  std::vector<std::string> all;
  if (!e.take_if("(")) return all;
  while (!e.is(")")) {
    if (!all.empty()) e.expect(",");
    if (e.now().kind != Token::Kind::name) e.fail("a name is missing here");
    all.push_back(e.take().text);
  }
  e.expect(")");
  return all;
}

}  // namespace

std::vector<Condition> conditions_of(const std::string& label,
                                     const PlacedText& code,
                                     const ClaimNames& names) {
  const Tokens tokens = tokens_of(code);
  const Expression::Locals none;
  int calls_left = kMostCalls;
  Expression e(tokens, names, none, calls_left);
  const PlacedText::Place place = e.now().place;
  const ClaimValue left = e.sum();
  std::vector<Condition> all;
  if (std::any_of(std::begin(kRelations),
                  std::end(kRelations),
                  [&](std::string_view r) { return e.is(r); })) {
    const Token relation = e.take();
    all = {of_relation(e, relation, label, e.as<Quantity>(left, place))};
  } else {
    all = without_relation(e, label, left, place);
  }
  if (e.take_if("of")) {
    e.expect("stages");
    for (Condition& c : all) c = of_stages(std::move(c));
  }
  e.expect_end();
  return all;
}

void define(const PlacedText& code, ClaimNames& names) {
  const Tokens tokens = tokens_of(code);
  const Expression::Locals none;
  int calls_left = kMostCalls;
  Expression e(tokens, names, none, calls_left);
  if (e.now().kind != Token::Kind::name) e.fail("a name is missing here");
  const Token name = e.take();
  const bool is_function = e.is("(");
  const std::vector<std::string> parameters = parameters_of(e);
  e.expect("=");
  if (!is_function) {
    names.set(name.text, e.sum());
    e.expect_end();
    return;
  }
  names.add(
      name.text,
      ClaimNames::Function{
          std::vector<std::type_index>(parameters.size(), typeid(ClaimValue)),
          [parameters, body = e.rest()](
              const ClaimNames::Call& call) -> std::optional<ClaimValue> {
            Expression::Locals locals;
            for (std::size_t k = 0; k < parameters.size(); ++k)
              locals[parameters[k]] = call.arguments[k];
            Expression inside(
                body, call.names, locals, call.calls_left, call.depth);
            ClaimValue result = inside.sum();
            inside.expect_end();
            return result;
          }});
}

}  // namespace physinv
