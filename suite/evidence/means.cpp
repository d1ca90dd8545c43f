#include "suite/evidence/means.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "suite/core/math.h"
#include "suite/evidence/statistics.h"

namespace physinv {
namespace {

std::vector<Select> runs_of(const std::vector<Quantity>& all) {
  std::vector<Select> runs;
  for (const Quantity& q : all)
    runs.insert(runs.end(), q.runs().begin(), q.runs().end());
  return runs;
}

}  // namespace

Quantity mean_of_all(const std::vector<Quantity>& all) {
  return {[all](const Evidence& evidence) {
            Measured sum{
                .value = 0, .spread = 0, .runs = kEvery, .missing = {}};
            for (const Quantity& q : all) {
              const Measured one = q(evidence);
              if (!one.value) return one;
              *sum.value += *one.value / double(all.size());
              const double s = one.spread.value_or(0) / double(all.size());
              sum.spread = math::hypot(
                  *sum.spread, s / std::sqrt(static_cast<double>(one.runs)));
              sum.runs = std::min(sum.runs, one.runs);
            }
            *sum.spread *= std::sqrt(static_cast<double>(sum.runs));
            return sum;
          },
          runs_of(all)};
}

Quantity growth_in_errors(const Select& a,
                          const Select& b,
                          const RunValue& value) {
  return {[=](const Evidence& e) {
            std::map<std::uint64_t, double> before;
            for (const Sample& s : sample(e, b, value))
              before[s.seed] = s.value;
            std::vector<double> differences;
            for (const Sample& s : sample(e, a, value))
              if (const auto at = before.find(s.seed); at != before.end())
                differences.push_back(s.value - at->second);
            const auto found = mean_std(differences);
            if (!found) return missing(a.text() + " not run");
            if (!found->std) return missing("two seeds");
            const auto runs = static_cast<double>(differences.size());
            return Measured{
                .value = found->mean / (*found->std / std::sqrt(runs)),
                .runs = static_cast<Index>(differences.size())};
          },
          {a, b}};
}

}  // namespace physinv
