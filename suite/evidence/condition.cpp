#include "suite/evidence/condition.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "suite/results/published.h"
#include "suite/results/results.h"

namespace physinv {
namespace {

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

/// `decide` gets value and bound once both are there. A bound with runs behind
/// it says its number beside its relation.
Condition compare(std::string label,
                  Quantity q,
                  const char* relation,
                  Quantity bound,
                  bool (*decide)(double, double)) {
  const bool measured = !bound.runs().empty() || !bound.printed().empty();
  const auto words = [=](const Measured& b) {
    if (b.value) return fmt::format("{} {}", relation, number_text(*b.value));
    return fmt::format("{} {}", relation, b.missing);
  };
  const std::string fixed =
      measured ? fmt::format("{} what is measured", relation)
               : words(Measured{.value = bound({{}, {}, ""}).value});
  return {label, fixed, {q, bound}, [=](const Evidence& e) {
            const Measured b = bound(e);
            ConditionResult r =
                result_of(label, measured ? words(b) : fixed, q(e));
            if (!b.value && r.missing.empty()) r.missing = b.missing;
            if (r.value && b.value) r.holds = decide(*r.value, *b.value);
            return r;
          }};
}

/// |m - p| <= allowance(measured, printed), not judged where that is empty.
template <class F>
Condition agree(
    std::string label, Quantity q, Quantity p, std::string words, F allowance) {
  return {label, words, {q, p}, [=](const Evidence& e) {
            const Measured target = p(e);
            ConditionResult r = result_of(label, words, q(e));
            if (!target.value) {
              if (r.missing.empty()) r.missing = target.missing;
              return r;
            }
            r.bounds = "printed " + number_text(*target.value);
            if (!r.value) return r;
            const std::optional<double> band = allowance(r, target);
            if (!band) {
              r.missing = "three seeds or a band of less than 20";
              return r;
            }
            r.bounds += " +- " + number_text(*band);
            r.holds = std::abs(*r.value - *target.value) <= *band;
            return r;
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
  return compare(std::move(label),
                 std::move(q),
                 ">=",
                 std::move(bound),
                 [](double a, double b) { return a >= b; });
}

Condition at_most(std::string label, Quantity q, Quantity bound) {
  return compare(std::move(label),
                 std::move(q),
                 "<=",
                 std::move(bound),
                 [](double a, double b) { return a <= b; });
}

Condition above(std::string label, Quantity q, Quantity bound) {
  return compare(std::move(label),
                 std::move(q),
                 ">",
                 std::move(bound),
                 [](double a, double b) { return a > b; });
}

Condition below(std::string label, Quantity q, Quantity bound) {
  return compare(std::move(label),
                 std::move(q),
                 "<",
                 std::move(bound),
                 [](double a, double b) { return a < b; });
}

Condition within(std::string label, Quantity q, double lowest, double highest) {
  const std::string words =
      fmt::format("in {} .. {}", number_text(lowest), number_text(highest));
  return {label, words, {q}, [=](const Evidence& e) {
            ConditionResult r = result_of(label, words, q(e));
            if (r.value) r.holds = *r.value >= lowest && *r.value <= highest;
            return r;
          }};
}

Condition report(std::string label, Quantity q) {
  return {label, "", {q}, [=](const Evidence& e) {
            return result_of(label, "", q(e));
          }};
}

Condition either(Condition a, Condition b) {
  std::vector<Quantity> both = a.quantities;
  both.insert(both.end(), b.quantities.begin(), b.quantities.end());
  const std::string bounds =
      fmt::format("{}, or {} {}", a.bounds, b.label, b.bounds);
  return {a.label, bounds, std::move(both), [=](const Evidence& e) {
            ConditionResult r = a.judge(e);
            if (r.holds.value_or(false)) return r;
            ConditionResult other = b.judge(e);
            if (other.holds.value_or(false)) return other;
            return r.holds && !other.holds ? other : r;
          }};
}

std::vector<Condition> joined(
    std::initializer_list<std::vector<Condition>> parts) {
  std::vector<Condition> all;
  for (const auto& part : parts)
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

Condition as_printed(std::string label, Quantity q, std::string quantity) {
  return agree(
      std::move(label),
      std::move(q),
      printed(quantity),
      "as printed (" + quantity + ")",
      [](const ConditionResult& m, const Measured& p) -> std::optional<double> {
        if (p.spread) {
          const double s = m.spread.value_or(0);
          return std::max(0.05, 2 * std::hypot(s, *p.spread));
        }
        if (m.runs < 3 || !m.spread || 2.83 * *m.spread > 20) return {};
        return std::max(0.05, 2.83 * *m.spread);
      });
}

Condition about(std::string label, Quantity percent, double x) {
  return agree(
      std::move(label),
      std::move(percent),
      Quantity(x),
      fmt::format("about {}", number_text(x)),
      [](const ConditionResult& m, const Measured&) -> std::optional<double> {
        const double error =
            m.spread.value_or(0) /
            std::sqrt(std::max<double>(1, static_cast<double>(m.runs)));
        return std::max(5.0, 2 * error);
      });
}

Condition near(std::string label, Quantity q, double v) {
  return within(std::move(label), std::move(q), v / 3.2, 3.2 * v);
}

}  // namespace physinv
