#include "suite/evidence/runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "suite/results/results.h"

namespace physinv {
namespace {

const StageRecord* stage_of(const CaseRecord& c, const std::string& name) {
  if (name.empty()) {
    const bool whole = c.stages.size() == c.info.stages.size();
    return whole && !c.stages.empty() && has_result(c.stages.back())
               ? &c.stages.back()
               : nullptr;
  }
  for (const StageRecord& s : c.stages)
    if (s.stage == name && has_result(s)) return &s;
  return nullptr;
}

}  // namespace

std::string Select::text() const {
  std::string out = experiment.empty() ? method : experiment + " " + method;
  if (!stage.empty()) out += " " + stage;
  if (first > 0 && first == last) return out + fmt::format(", n = {}", first);
  if (first > 0) out += fmt::format(", n >= {}", first);
  if (last < kEvery) out += fmt::format(", n <= {}", last);
  return out;
}

Index Run::n() const { return record->info.n; }
std::uint64_t Run::seed() const { return record->info.seed; }

std::optional<Run> Run::beside(const Select& other) const {
  for (const Run& run : find_runs(*evidence, other.of_sizes(n(), n())))
    if (run.seed() == seed()) return run;
  return {};
}

std::vector<Run> find_runs(const Evidence& evidence, const Select& select) {
  const std::string& experiment =
      select.experiment.empty() ? evidence.experiment : select.experiment;
  std::vector<Run> found;
  for (const CaseRecord& c : evidence.results.cases()) {
    if (c.info.method != select.method || c.info.experiment != experiment ||
        c.info.n < select.first || c.info.n > select.last)
      continue;
    if (const StageRecord* stage = stage_of(c, select.stage))
      found.push_back({&evidence, &c, stage});
  }
  std::sort(found.begin(), found.end(), [](const Run& a, const Run& b) {
    return std::tuple(a.n(), a.seed()) < std::tuple(b.n(), b.seed());
  });
  return found;
}

std::optional<Run> first_run(const Evidence& evidence, const Select& select) {
  const auto all = find_runs(evidence, select);
  return all.empty() ? std::nullopt : std::optional(all.front());
}

std::vector<Sample> sample(const Evidence& evidence,
                           const Select& select,
                           const RunValue& value) {
  std::vector<Sample> samples;
  for (const Run& run : find_runs(evidence, select))
    if (const auto v = value(run)) samples.push_back({run.n(), run.seed(), *v});
  return samples;
}

std::vector<double> values_of(const std::vector<Sample>& samples) {
  std::vector<double> values;
  for (const Sample& s : samples) values.push_back(s.value);
  return values;
}

std::vector<double> seed_means(const std::vector<Sample>& samples) {
  std::map<std::uint64_t, std::pair<double, double>> sums;
  for (const Sample& s : samples) {
    auto& [sum, count] = sums[s.seed];
    sum += s.value, count += 1;
  }
  std::vector<double> means;
  for (const auto& [seed, sum] : sums) means.push_back(sum.first / sum.second);
  return means;
}

}  // namespace physinv
