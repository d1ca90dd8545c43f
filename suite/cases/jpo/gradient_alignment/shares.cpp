#include "suite/cases/jpo/gradient_alignment/shares.h"

#include <cmath>
#include <string>
#include <string_view>

#include "suite/cases/jpo/common/metrics.h"

namespace physinv::alignment {
namespace {

std::optional<Measured> measured(const Results& results,
                                 std::string_view method,
                                 const std::string& array) {
  Measured out;
  for (const Index n : results.sizes(kName)) {
    std::vector<double> all;  // of all seeds
    for (const auto seed : results.seeds(kName)) {
      const auto* stage = results.find(kName, method, n, seed, "measure");
      if (stage == nullptr) continue;
      const auto found = stage->arrays.find(array);
      if (found == stage->arrays.end()) continue;
      const auto values = found->second.reshaped();
      all.insert(all.end(), values.begin(), values.end());
    }
    const auto mean = mean_std(all);
    if (!mean) continue;
    const auto count = static_cast<Index>(all.size());
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

}  // namespace

Fig2::Fig2(const Results& results, const Response& printed)
    : known_sum(measured(results, "known", "sum")),
      known_vote(measured(results, "known", "vote")),
      unequal_sum(measured(results, "unequal", "sum")),
      unequal_vote(measured(results, "unequal", "vote")),
      linear(measured(results, "linear", "noise_free")),
      free(measured(results, "sine", "noise_free")),
      sum(measured(results, "sine", "sum")),
      vote(measured(results, "sine", "vote")),
      paper(printed) {
  if (linear) linear_fit = fit_response(linear->n, linear->share);
  if (free) sine_fit = fit_response(free->n, free->share);
}

}  // namespace physinv::alignment
