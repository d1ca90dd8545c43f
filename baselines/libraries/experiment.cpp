// Experiments `libraries/<problem>`: the suite's problems, starts and sizes,
// solved by its optimizers and by those of other libraries.
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

/// Of `smoke`, which takes seconds.
constexpr Index kFew = 8;

struct Problem {
  std::string name;
  Index smoke_size = kFew;  ///< problems at most
};

/// Of `smoke` the few problems alone; no row if it has none.
std::vector<physinv::Row> rows(const physinv::Profile& profile,
                               physinv::Row row,
                               Index smoke_size) {
  if (profile.name == "smoke") {
    std::erase_if(row.n, [](Index n) { return n > kFew; });
    for (Index& n : row.n) n = std::min(n, smoke_size);
  }
  if (row.n.empty()) return {};
  return {std::move(row)};
}

/// Programs over one folder of experiments lack those of the others.
void add(const Problem& problem) {
  const std::string of = "jpo/" + problem.name;
  const std::string name = "libraries/" + problem.name;
  const auto base = physinv::registry().find(of);
  if (base == nullptr) return;
  const auto all = solvers(*base);
  auto profiles = profiles_with(
      *base, "bfgs", [&](const physinv::Profile& profile, physinv::Row row) {
        row.methods = ids(all);
        return rows(profile, std::move(row), problem.smoke_size);
      });
  physinv::register_study(name, of);  // the same problems
  physinv::register_experiment({.name = name,
                                .title = base->title + ", other libraries",
                                .citation = base->citation,
                                .problem = base->problem,
                                .setting = base->setting,
                                .profiles = std::move(profiles),
                                .methods = all,
                                .styles = base->styles,
                                .report = [](const physinv::Evidence& e) {
                                  return physinv::Section{
                                      .tables = {ends_table(e)}};
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
