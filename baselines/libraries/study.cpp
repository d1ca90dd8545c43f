// Study `studies/whose-bfgs-<problem>`: joint optimization as in the JPO paper
// against each library's solver and settings of the suite's BFGS, on the same
// problems from the same starts.
#include "suite/harness/study.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "solvers.h"
#include "whose_bfgs.h"
#include "whose_bfgs_claims.h"

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
bool has(const std::string& problem) {
  return physinv::registry().find("jpo/" + problem) != nullptr;
}

/// There BFGS has a setting of its own, which others do not vary, and a network
/// takes minutes: only the paper's sizes are run.
bool is_flow(const physinv::Experiment& base) {
  return base.name == "jpo/navier-stokes";
}

std::vector<physinv::Method> methods_of(const physinv::Experiment& base) {
  auto methods = solvers(base);
  if (!is_flow(base))
    for (auto& setting : bfgs_settings(base))
      methods.push_back(std::move(setting));
  return methods;
}

void add(const std::string& problem) {
  if (!has(problem)) return;
  const std::string of = "jpo/" + problem, name = study_of(problem);
  const auto base = physinv::registry().find(of);
  auto methods = methods_of(*base);
  const bool first =
      problem == section4().front() && std::ranges::all_of(section4(), has);
  auto profiles = profiles_with(
      *base, "jpo", [&](const physinv::Profile&, physinv::Row row) {
        return rows(std::move(row), methods);
      });
  if (is_flow(*base))
    std::erase_if(profiles, [](const physinv::Profile& profile) {
      return profile.name != "paper";
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
       .claims = first ? whose_bfgs_claims() : std::vector<physinv::Claim>{},
       .styles = base->styles,
       .report = [of, first](const physinv::Evidence& e) {
         auto section = whose_bfgs(of, e);
         if (first)
           section.figures.insert(section.figures.begin(), at_a_glance(e));
         return section;
       }});
}

const bool kRegistered = [] {
  for (const std::string& problem : section4()) add(problem);
  add("robotic-arm");
  return true;
}();

}  // namespace
}  // namespace libraries
