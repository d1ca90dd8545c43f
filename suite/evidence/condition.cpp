#include "suite/evidence/condition.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace physinv {

ConditionResult result_of(const std::string& label,
                          const std::string& bounds,
                          const Measured& m) {
  return {.label = label,
          .bounds = bounds,
          .value = m.value,
          .spread = m.spread,
          .runs = static_cast<std::int64_t>(m.runs),
          .holds = {},
          .missing = m.missing};
}

ConditionResult Condition::judge(const Evidence& evidence) const {
  ConditionResult r;
  if (alternatives.empty()) {
    r = result_of(label, bounds, quantities.front()(evidence));
    if (decide) decide(evidence, r);
  } else {
    // One that holds, else one that is not decided.
    r = alternatives.front().judge(evidence);
    for (std::size_t k = 1; k < alternatives.size(); ++k) {
      if (r.holds.value_or(false)) break;
      ConditionResult next = alternatives[k].judge(evidence);
      if (next.holds.value_or(false) || (r.holds && !next.holds))
        r = std::move(next);
    }
  }
  if (r.label == label) r.shown = shown;
  return r;
}

namespace {

/// A bound with runs behind it shows its number next to its relation.
Condition compare(std::string label,
                  Quantity q,
                  const char* relation,
                  Quantity bound,
                  std::function<bool(double, double)> holds) {
  const auto words = [=](const Measured& b) {
    return fmt::format(
        "{} {}", relation, b.value ? number_text(*b.value) : b.missing);
  };
  const bool measured = !bound.runs().empty() || !bound.printed().empty();
  return {.label = std::move(label),
          .bounds = measured ? fmt::format("{} what is measured", relation)
                             : words(bound({{}, {}, ""})),
          .quantities = {std::move(q), bound},
          .decide = [=](const Evidence& e, ConditionResult& r) {
            const Measured b = bound(e);
            r.bounds = words(b);
            if (!b.value && r.missing.empty()) r.missing = b.missing;
            if (r.value && b.value) r.holds = holds(*r.value, *b.value);
          }};
}

}  // namespace

std::string number_text(double value) {
  if (!std::isfinite(value)) return "not finite";
  const double size = std::abs(value);
  if (size < 1e5 && value == std::round(value))
    return fmt::format("{:.0f}", value);
  const bool plain = size >= 1e-3 && size < 1e5;
  return plain ? fmt::format("{:.3g}", value) : fmt::format("{:.2e}", value);
}

Condition at_least(std::string label, Quantity q, Quantity bound) {
  return compare(label, q, ">=", bound, std::greater_equal<>());
}
Condition at_most(std::string label, Quantity q, Quantity bound) {
  return compare(label, q, "<=", bound, std::less_equal<>());
}
Condition above(std::string label, Quantity q, Quantity bound) {
  return compare(label, q, ">", bound, std::greater<>());
}
Condition below(std::string label, Quantity q, Quantity bound) {
  return compare(label, q, "<", bound, std::less<>());
}

Condition equals(std::string label, Quantity q, double value, double off) {
  return within(std::move(label), std::move(q), value - off, value + off);
}

Condition within(std::string label, Quantity q, double lowest, double highest) {
  const std::string words =
      fmt::format("in {} .. {}", number_text(lowest), number_text(highest));
  return {.label = std::move(label),
          .bounds = words,
          .quantities = {std::move(q)},
          .decide = [=](const Evidence&, ConditionResult& r) {
            r.bounds = words;
            if (r.value) r.holds = *r.value >= lowest && *r.value <= highest;
          }};
}

std::vector<Condition> below_on_every_seed(const std::string& label,
                                           const Select& a,
                                           const Select& b,
                                           const RunValue& value) {
  const Quantity worst = worst_ratio(a, b, value);
  return {below(label + ", worst seed", worst, 1),
          below("of two seeds at least", from_at_least(2, worst), 1)};
}

Condition reported(std::string label, Quantity q) {
  return {
      .label = std::move(label), .bounds = {}, .quantities = {std::move(q)}};
}

Condition either(Condition a, Condition b) {
  std::vector<Quantity> both = a.quantities;
  both.insert(both.end(), b.quantities.begin(), b.quantities.end());
  return {.label = a.label,
          .bounds = fmt::format("{}, or {} {}", a.bounds, b.text(), b.bounds),
          .quantities = std::move(both),
          .alternatives = {a, b},
          .shown = a.shown};
}

Condition of_stages(Condition c) {
  c.of_stages = true;
  for (Condition& one : c.alternatives) one.of_stages = true;
  return c;
}

Condition shown_as(Condition c, std::string text) {
  c.shown = std::move(text);
  return c;
}

std::vector<Condition> joined(
    std::initializer_list<std::vector<Condition>> parts) {
  std::vector<Condition> all;
  for (const auto& part : parts)
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

Condition near(std::string label, Quantity q, double v) {
  return within(std::move(label), std::move(q), v / 3.2, 3.2 * v);
}

}  // namespace physinv
