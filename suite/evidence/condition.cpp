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

namespace {

/// `decide` gets value and bound once both are there. A bound with runs behind
/// it says its number beside its relation.
Condition compare(std::string label,
                  Quantity q,
                  const char* relation,
                  Quantity bound,
                  std::function<bool(double, double)> decide) {
  const bool measured = !bound.runs().empty() || !bound.printed().empty();
  const auto words = [=](const Measured& b) {
    if (b.value) return fmt::format("{} {}", relation, number_text(*b.value));
    return fmt::format("{} {}", relation, b.missing);
  };
  const std::string fixed =
      measured ? fmt::format("{} what is measured", relation)
               : words(Measured{.value = bound({{}, {}, ""}).value});
  return {label,
          fixed,
          {q, bound},
          [=](const Evidence& e) {
            const Measured b = bound(e);
            ConditionResult r =
                result_of(label, measured ? words(b) : fixed, q(e));
            if (!b.value && r.missing.empty()) r.missing = b.missing;
            if (r.value && b.value) r.holds = decide(*r.value, *b.value);
            return r;
          },
          [=](const Evidence& e, const Kept&, ConditionResult& kept) {
            // What a measured bound was, its words say with fewer digits.
            if (measured || !kept.value) return;
            kept.bounds = fixed;
            kept.holds = decide(*kept.value, *bound(e).value);
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
  return {label,
          words,
          {q},
          [=](const Evidence& e) {
            ConditionResult r = result_of(label, words, q(e));
            if (r.value) r.holds = *r.value >= lowest && *r.value <= highest;
            return r;
          },
          [=](const Evidence&, const Kept&, ConditionResult& kept) {
            if (!kept.value) return;
            kept.bounds = words;
            kept.holds = *kept.value >= lowest && *kept.value <= highest;
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
  return {label, "", {q}, [=](const Evidence& e) {
            return result_of(label, "", q(e));
          }};
}

Condition either(Condition a, Condition b) {
  std::vector<Quantity> both = a.quantities;
  both.insert(both.end(), b.quantities.begin(), b.quantities.end());
  const std::string bounds =
      fmt::format("{}, or {} {}", a.bounds, b.text(), b.bounds);
  return {.label = a.label,
          .bounds = bounds,
          .quantities = std::move(both),
          .judge =
              [=](const Evidence& e) {
                ConditionResult r = a.judge(e);
                if (r.holds.value_or(false)) return r;
                ConditionResult other = b.judge(e);
                if (other.holds.value_or(false)) return other;
                return r.holds && !other.holds ? other : r;
              },
          .alternatives = {a, b},
          .shown = a.shown};
}

Condition of_stages(Condition c) {
  c.of_stages = true;
  for (Condition& one : c.alternatives) one.of_stages = true;
  return c;
}

Condition shown_as(Condition c, std::string text) {
  c.judge = [=, judge = std::move(c.judge)](const Evidence& e) {
    ConditionResult r = judge(e);
    r.shown = text;
    return r;
  };
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
