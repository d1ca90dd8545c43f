// Study `studies/whose-bfgs-<problem>`: joint optimization as in the JPO paper
// against each library's solver, on the same problems from the same starts.
#include "suite/harness/study.h"

#include <string>
#include <utility>
#include <vector>

#include "solvers.h"
#include "whose_bfgs.h"

namespace libraries {
namespace {

using physinv::Profile;

/// The rows in which JPO runs, for it alone, and for all solvers on the same
/// problems, each to its own limit.
std::vector<Profile> profiles(const physinv::Experiment& of,
                              const std::vector<physinv::Method>& methods) {
  std::vector<Profile> result;
  for (const Profile& profile : of.profiles) {
    Profile mine{.name = profile.name, .rows = {}};
    for (physinv::Row row : profile.rows) {
      if (!has(row, "jpo")) continue;
      row.methods = {"jpo"};
      mine.rows.push_back(row);
      row.methods = ids(methods);
      row.iterations = 0;
      mine.rows.push_back(std::move(row));
    }
    result.push_back(std::move(mine));
  }
  return result;
}

/// Programs over one folder of experiments lack those of the others.
void add(const std::string& problem) {
  const std::string of = "jpo/" + problem;
  const std::string name = "studies/whose-bfgs-" + problem;
  const auto base = physinv::registry().find(of);
  if (base == nullptr) return;
  auto methods = solvers(*base);
  auto rows = profiles(*base, methods);
  methods.push_back(*physinv::find_method(*base, "jpo"));
  physinv::register_study(name, of);
  physinv::register_experiment(
      {.name = name,
       .title = base->title + ", whose BFGS",
       .citation = {.paper = "jpo", .where = "Tables 4 and 5, Fig. 11"},
       .problem = base->problem,
       .setting = base->setting,
       .profiles = std::move(rows),
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
