// Experiments `libraries/<problem>`: problems, starts and sizes of the suite's
// own, solved by the suite's optimizers and by those of other libraries.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "ends.h"
#include "solvers.h"
#include "suite/harness/study.h"

namespace libraries {
namespace {

using physinv::Index;
using physinv::Profile;

/// Of `smoke`, which takes seconds.
constexpr Index kFew = 8;

struct Problem {
  std::string name;
  Index smoke_size = kFew;  ///< problems at most
};

/// The rows in which the suite's BFGS runs, for all methods here; of `smoke`
/// those of few problems.
std::vector<Profile> profiles(const physinv::Experiment& of,
                              Index smoke_size,
                              const std::vector<physinv::Method>& methods) {
  std::vector<Profile> result;
  for (const Profile& profile : of.profiles) {
    Profile mine{.name = profile.name, .rows = {}};
    for (physinv::Row row : profile.rows) {
      if (!has(row, "bfgs")) continue;
      if (profile.name == "smoke") {
        std::erase_if(row.n, [](Index n) { return n > kFew; });
        for (Index& n : row.n) n = std::min(n, smoke_size);
      }
      if (row.n.empty()) continue;
      row.methods = ids(methods);
      mine.rows.push_back(std::move(row));
    }
    if (!mine.rows.empty()) result.push_back(std::move(mine));
  }
  return result;
}

/// Programs over one folder of experiments lack those of the others.
void add(const Problem& problem) {
  const std::string of = "jpo/" + problem.name;
  const std::string name = "libraries/" + problem.name;
  const auto base = physinv::registry().find(of);
  if (base == nullptr) return;
  const auto all = solvers(*base);
  physinv::register_study(name, of);  // the same problems
  physinv::register_experiment(
      {.name = name,
       .title = base->title + ", other libraries",
       .citation = base->citation,
       .problem = base->problem,
       .setting = base->setting,
       .profiles = profiles(*base, problem.smoke_size, all),
       .methods = all,
       .styles = base->styles,
       .report = [](const physinv::Evidence& e) {
         return physinv::Section{.tables = {ends_table(e)}};
       }});
}

const bool kRegistered = [] {
  for (const Problem& problem :
       std::vector<Problem>{{"billiards"},
                            {"wave-packet"},
                            {"robotic-arm"},
                            {"kuramoto-sivashinsky"},
                            {.name = "navier-stokes", .smoke_size = 1}})
    add(problem);
  return true;
}();

}  // namespace
}  // namespace libraries
