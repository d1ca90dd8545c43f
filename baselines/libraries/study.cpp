// Study `studies/whose-bfgs-<problem>`: joint optimization as in the JPO paper
// against each library's solver and settings of the suite's BFGS, on the same
// problems from the same starts.
#include "suite/harness/study.h"

#include <string>
#include <utility>
#include <vector>

#include "solvers.h"
#include "whose_bfgs.h"

namespace libraries {
namespace {

/// JPO alone, and all solvers on the same problems, each to its own limit.
std::vector<physinv::Row> rows(physinv::Row row,
                               const std::vector<physinv::Method>& methods) {
  row.methods = {"jpo"};
  physinv::Row others = row;
  others.methods = ids(methods);
  others.iterations = 0;
  return {std::move(row), std::move(others)};
}

/// Programs over one folder of experiments lack those of the others.
void add(const std::string& problem) {
  const std::string of = "jpo/" + problem;
  const std::string name = "studies/whose-bfgs-" + problem;
  const auto base = physinv::registry().find(of);
  if (base == nullptr) return;
  auto methods = solvers(*base);
  for (auto& setting : bfgs_settings(*base))
    methods.push_back(std::move(setting));
  auto profiles = profiles_with(
      *base, "jpo", [&](const physinv::Profile&, physinv::Row row) {
        return rows(std::move(row), methods);
      });
  methods.push_back(*physinv::find_method(*base, "jpo"));
  physinv::register_study(name, of);
  physinv::register_experiment(
      {.name = name,
       .title = base->title + ", whose BFGS",
       .citation = {.paper = "jpo", .where = "Tables 4 and 5, Fig. 11"},
       .problem = base->problem,
       .setting = base->setting,
       .profiles = std::move(profiles),
       .methods = std::move(methods),
       .styles = base->styles,
       .report = [of](const physinv::Evidence& e) {
         return whose_bfgs(of, e);
       }});
}

const bool kRegistered = [] {
  for (const char* problem :
       {"billiards", "wave-packet", "robotic-arm", "kuramoto-sivashinsky"})
    add(problem);
  return true;
}();

}  // namespace
}  // namespace libraries
