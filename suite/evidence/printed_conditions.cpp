// Conditions that hold a number against one that the paper prints.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "suite/evidence/condition.h"
#include "suite/evidence/statistics.h"
#include "suite/results/results.h"

namespace physinv {
namespace {

/// |m - p| <= allowance(measured, p), not judged where that is empty.
template <class F>
Condition agree(
    std::string label, Quantity q, Quantity p, std::string words, F allowance) {
  return {.label = std::move(label),
          .bounds = std::move(words),
          .quantities = {std::move(q), p},
          .decide = [=](const Evidence& e, ConditionResult& r) {
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
          }};
}

/// Half a digit of what is printed.
constexpr double kRounding = 0.05;

/// Problems behind a seed's mean of shares over n, as to its scatter: the
/// square of how many n over the sum of 1 / n. The mean over seeds; 0 for no
/// runs.
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
  std::vector<Quantity::Part> parts;
  std::vector<std::string> names;
  std::vector<Condition> out;
  for (const PrintedMean& m : means) {
    parts.push_back({m.label, m.quantity});
    names.push_back(m.name);
    out.push_back(reported(m.label, m.quantity));
    out.push_back(reported("printed", printed(m.name)));
  }
  const auto probability = [=](const std::vector<Measured>& ours,
                               const Evidence& e) -> Measured {
    Differences all(seeds);
    for (std::size_t k = 0; k < ours.size(); ++k)
      if (const auto lacks = all.add(ours[k], printed(names[k])(e));
          !lacks.empty())
        return missing(lacks);
    return all.probability();
  };
  out.insert(out.begin(),
             at_least(std::move(label),
                      Quantity::made_of(parts, probability, names),
                      kUnlikely));
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

}  // namespace physinv
