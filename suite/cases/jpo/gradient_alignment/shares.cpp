#include "suite/cases/jpo/gradient_alignment/shares.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "suite/evidence/statistics.h"
#include "suite/results/published.h"
#include "suite/store/record.h"

namespace physinv::alignment {
namespace {

std::optional<Aligned> measured(const Evidence& evidence,
                                const std::string& method,
                                ArrayKey array) {
  std::map<Index, std::vector<double>> all;  // of all seeds
  for (const Run& run : find_runs(evidence, {method, "measure"})) {
    const auto found = run.stage->arrays.find(array);
    if (found == run.stage->arrays.end()) continue;
    const auto values = found->second.reshaped();
    auto& at = all[run.n()];
    at.insert(at.end(), values.begin(), values.end());
  }
  Aligned out;
  for (const auto& [n, values] : all) {
    const auto mean = mean_std(values);
    if (!mean) continue;
    const auto count = static_cast<Index>(values.size());
    out.n.push_back(n);
    out.share.push_back(mean->mean);
    out.error.push_back(mean->std.value_or(0) /
                        std::sqrt(static_cast<double>(count)));
    out.repetitions =
        out.n.size() == 1 ? count : std::min(out.repetitions, count);
  }
  if (out.n.empty()) return {};
  return out;
}

double printed(const Evidence& evidence,
               const char* quantity,
               double otherwise) {
  const auto found = evidence.published.find(kName, quantity);
  return found ? found->value : otherwise;
}

/// Each fit is made once, as every claim and figure asks for it. Known by the
/// bits of what was measured, which may be no numbers.
ResponseFit fitted(const Aligned& a) {
  static std::map<std::string, ResponseFit> known;
  const auto bytes = [](const auto& v) {
    return std::string(reinterpret_cast<const char*>(v.data()),
                       v.size() * sizeof(v[0]));
  };
  const auto [at, is_new] = known.try_emplace(bytes(a.n) + bytes(a.share));
  if (is_new) at->second = fit_response(a.n, a.share);
  return at->second;
}

}  // namespace

Fig2::Fig2(const Evidence& e)
    : known_sum(measured(e, "known", "sum")),
      known_vote(measured(e, "known", "vote")),
      unequal_sum(measured(e, "unequal", "sum")),
      unequal_vote(measured(e, "unequal", "vote")),
      linear(measured(e, "linear", "noise_free")),
      free(measured(e, "sine", "noise_free")),
      sum(measured(e, "sine", "sum")),
      vote(measured(e, "sine", "vote")),
      paper({.complexity = printed(e, "fig2b/C", 6.4),
             .plasticity = printed(e, "fig2b/A", 12.9)}) {
  if (linear) linear_fit = fitted(*linear);
  if (free) sine_fit = fitted(*free);
}

bool Fig2::has(std::string_view method) const {
  using Parts = std::vector<const std::optional<Aligned>*>;
  const std::map<std::string_view, Parts> parts{
      {"known", {&known_sum, &known_vote}},
      {"unequal", {&unequal_sum, &unequal_vote}},
      {"linear", {&linear}},
      {"sine", {&free, &sum, &vote}}};
  const Parts& own = parts.at(method);
  return std::all_of(own.begin(), own.end(), [&](const auto* part) {
    return *part && (*part)->n == own.front()->value().n;
  });
}

}  // namespace physinv::alignment
