#include "suite/evidence/condition.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "suite/evidence/statistics.h"
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

/// |m - p| <= allowance(measured, p), not judged where that is empty.
template <class F>
Condition agree(
    std::string label, Quantity q, Quantity p, std::string words, F allowance) {
  const auto decide = [=](const Evidence& e, ConditionResult& r) {
    const Measured target = p(e);
    r.holds.reset();
    if (!target.value) {
      if (r.missing.empty()) r.missing = target.missing;
      return;
    }
    r.bounds = "printed " + number_text(*target.value);
    if (!r.value) return;
    const std::optional<double> band = allowance(e, r, *target.value);
    if (!band) {
      r.missing = "three seeds";
      return;
    }
    r.bounds += " +- " + number_text(*band);
    r.holds = std::abs(*r.value - *target.value) <= *band;
  };
  return {label,
          words,
          {q, p},
          [=](const Evidence& e) {
            ConditionResult r = result_of(label, words, q(e));
            decide(e, r);
            return r;
          },
          [=](const Evidence& e, const Kept&, ConditionResult& kept) {
            decide(e, kept);
          }};
}

/// Half a digit of what is printed.
constexpr double kRounding = 0.05;

/// Problems behind a seed's mean of shares over n, as far as its scatter goes:
/// the square of how many n over the sum of 1 / n. The mean over seeds; 0 for
/// no runs.
double problems_behind(const Evidence& e, const Select& runs) {
  std::map<std::uint64_t, std::pair<double, double>> seeds;
  for (const Run& run : find_runs(e, runs)) {
    auto& [count, inverse] = seeds[run.seed()];
    count += 1, inverse += 1 / static_cast<double>(run.n());
  }
  double all = 0;
  for (const auto& [seed, s] : seeds) all += s.first * s.first / s.second;
  return seeds.empty() ? 0 : all / static_cast<double>(seeds.size());
}

/// Twice the standard error of the difference of our mean and one over so many
/// seeds, in per cent.
auto band_of_means(Quantity q, Index seeds) {
  return [=](const Evidence& e,
             const ConditionResult& m,
             double printed) -> std::optional<double> {
    if (m.runs < 3 || !m.spread) return {};
    double variance = *m.spread * *m.spread;
    if (q.runs().size() == 1) {
      const double p = std::clamp(0.005 * (*m.value + printed), 0.0, 1.0);
      const double problems = problems_behind(e, q.runs().front());
      if (problems > 0)
        variance = std::max(variance, 1e4 * p * (1 - p) / problems);
    }
    const double shares =
        1 / static_cast<double>(m.runs) + 1 / static_cast<double>(seeds);
    return std::max(kRounding, 2 * std::sqrt(variance * shares));
  };
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

namespace {

/// The word before the numbers: ">", "in", "printed", "about"; whatever a
/// number was held against.
std::string_view relation_of(std::string_view bounds) {
  const auto word = bounds.substr(0, bounds.find(' '));
  return word == "as" || word == "about" ? "printed" : word;
}

const ConditionResult* find(const Kept& kept, const std::string& label) {
  for (const ConditionResult& c : kept)
    if (c.label == label) return &c;
  return nullptr;
}

}  // namespace

ConditionResult decide_again(const Condition& condition,
                             const Kept& kept,
                             const Evidence& evidence) {
  const auto& asks = condition.quantities;
  if (std::all_of(asks.begin(), asks.end(), [](const Quantity& q) {
        return q.runs().empty();
      }))
    return condition.judge(evidence);
  for (const Condition& one : condition.alternatives) {
    ConditionResult r = decide_again(one, kept, evidence);
    if (r.missing != kNotKept) return r;
  }
  for (const ConditionResult& old : kept) {
    if (old.label != condition.label) continue;
    ConditionResult r = old;
    if (condition.bounds.empty()) r.bounds.clear(), r.holds.reset();
    if (relation_of(r.bounds) != relation_of(condition.bounds)) continue;
    if (condition.again) condition.again(evidence, kept, r);
    return r;
  }
  ConditionResult r{.label = condition.label, .bounds = condition.bounds};
  r.missing = kNotKept;
  const auto& parts = condition.parts;
  if (!parts.empty() &&
      std::all_of(parts.begin(), parts.end(), [&](const std::string& part) {
        return find(kept, part) != nullptr;
      }))
    condition.again(evidence, kept, r);
  return r;
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
          .alternatives = {a, b}};
}

std::vector<Condition> joined(
    std::initializer_list<std::vector<Condition>> parts) {
  std::vector<Condition> all;
  for (const auto& part : parts)
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

Condition as_printed(std::string label,
                     Quantity q,
                     std::string quantity,
                     Index seeds) {
  return agree(std::move(label),
               q,
               printed(quantity),
               "as printed (" + quantity + ")",
               band_of_means(q, seeds));
}

Condition as_stated(std::string label,
                    Quantity percent,
                    double stated,
                    Index seeds) {
  return agree(std::move(label),
               percent,
               Quantity(stated),
               fmt::format("as printed ({})", number_text(stated)),
               band_of_means(percent, seeds));
}

namespace {

/// One term of chi squared after the other.
class Differences {
 public:
  explicit Differences(Index seeds) : seeds_(static_cast<double>(seeds)) {}

  /// What is missing, empty if nothing.
  std::string add(const Measured& m, const Measured& p) {
    if (!m.value) return m.missing;
    if (!p.value) return p.missing;
    if (m.runs < 3 || !m.spread) return "three seeds";
    const double b = p.spread.value_or(0);
    const double variance =
        *m.spread * *m.spread / static_cast<double>(m.runs) + b * b / seeds_ +
        2 * kRounding * kRounding / 3;
    sum_ += (*m.value - *p.value) * (*m.value - *p.value) / variance;
    runs_ = m.runs, ++terms_;
    return "";
  }
  Measured probability() const {
    return {.value = chi_squared_tail(sum_, terms_), .runs = runs_};
  }

 private:
  double seeds_, sum_ = 0;
  Index runs_ = 0;
  int terms_ = 0;
};

constexpr double kUnlikely = 0.05;

}  // namespace

std::vector<Condition> jointly_as_printed(std::string label,
                                          std::vector<PrintedMean> means,
                                          Index seeds) {
  std::vector<Select> runs;
  std::vector<std::string> names, parts;
  std::vector<Condition> out;
  for (const PrintedMean& m : means) {
    runs.insert(runs.end(), m.quantity.runs().begin(), m.quantity.runs().end());
    names.push_back(m.name), parts.push_back(m.label);
    out.push_back(report(m.label, m.quantity));
    out.push_back(report("printed", printed(m.name)));
  }
  const auto probability = [=](const Evidence& e) -> Measured {
    Differences all(seeds);
    for (const PrintedMean& m : means)
      if (const auto lacks = all.add(m.quantity(e), printed(m.name)(e));
          !lacks.empty())
        return missing(lacks);
    return all.probability();
  };
  Condition jointly =
      at_least(std::move(label),
               Quantity(probability, std::move(runs), std::move(names)),
               kUnlikely);
  jointly.parts = std::move(parts);
  jointly.again = [=](const Evidence& e, const Kept& kept, ConditionResult& r) {
    Differences all(seeds);
    for (const PrintedMean& m : means) {
      const ConditionResult* old = find(kept, m.label);
      if (old == nullptr) return;
      r.missing = all.add({old->value, old->spread, old->runs, old->missing},
                          printed(m.name)(e));
      if (!r.missing.empty()) return;
    }
    const Measured found = all.probability();
    r.value = found.value, r.runs = found.runs;
    r.holds = *r.value >= kUnlikely;
  };
  out.insert(out.begin(), std::move(jointly));
  return out;
}

Condition about(std::string label, Quantity percent, double x) {
  return agree(std::move(label),
               std::move(percent),
               Quantity(x),
               fmt::format("about {}", number_text(x)),
               [](const Evidence&,
                  const ConditionResult& m,
                  double) -> std::optional<double> {
                 const double error = m.spread.value_or(0) /
                                      std::sqrt(std::max<double>(
                                          1, static_cast<double>(m.runs)));
                 return std::max(5.0, 2 * error);
               });
}

Condition near(std::string label, Quantity q, double v) {
  return within(std::move(label), std::move(q), v / 3.2, 3.2 * v);
}

}  // namespace physinv
