#include "suite/results/results.h"

#include <algorithm>
#include <set>

#include "suite/store/catalog.h"

namespace physinv {
namespace {

/// Sorted and different values of get(info) over an experiment's cases.
template <class T, class F>
std::vector<T> values(const std::vector<CaseRecord>& cases,
                      std::string_view experiment,
                      F&& get) {
  std::set<T> all;
  for (const auto& c : cases)
    if (c.info.experiment == experiment) all.insert(get(c.info));
  return {all.begin(), all.end()};
}

}  // namespace

Results::Results(std::vector<CaseRecord> cases) : cases_(std::move(cases)) {}

const CaseRecord* Results::find_case(std::string_view experiment,
                                     std::string_view method,
                                     Index n,
                                     std::uint64_t seed) const {
  for (const auto& c : cases_) {
    if (c.info.n == n && c.info.seed == seed && c.info.method == method &&
        c.info.experiment == experiment)
      return &c;
  }
  return nullptr;
}

const StageRecord* Results::find(std::string_view experiment,
                                 std::string_view method,
                                 Index n,
                                 std::uint64_t seed,
                                 std::string_view stage) const {
  const CaseRecord* c = find_case(experiment, method, n, seed);
  if (c == nullptr) return nullptr;
  const auto at =
      std::find_if(c->stages.begin(), c->stages.end(), [&](const auto& s) {
        return s.stage == stage && s.stop != Stop::failed &&
               s.stop != Stop::skipped;
      });
  return at == c->stages.end() ? nullptr : &*at;
}

std::vector<Index> Results::sizes(std::string_view experiment) const {
  return values<Index>(
      cases_, experiment, [](const CaseInfo& i) { return i.n; });
}

std::vector<std::uint64_t> Results::seeds(std::string_view experiment) const {
  return values<std::uint64_t>(
      cases_, experiment, [](const CaseInfo& i) { return i.seed; });
}

std::vector<std::string> Results::methods(std::string_view experiment) const {
  return values<std::string>(
      cases_, experiment, [](const CaseInfo& i) { return i.method; });
}

std::map<std::string, Counts> work_of(const Results& results) {
  std::map<std::string, Counts> work;
  for (const CaseRecord& c : results.cases())
    for (const StageRecord& s : c.stages)
      if (has_result(s)) work[c.info.experiment] += s.counts;
  return work;
}

Results load_results(const std::filesystem::path& directory) {
  return Results(Catalog::read(directory).cases());
}

}  // namespace physinv
