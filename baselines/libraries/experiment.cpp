// Experiments `libraries/<problem>`: problems, starts and sizes of the suite's
// own, solved by the suite's optimizers and by those of other libraries.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "ceres_solvers.h"
#include "dlib_solvers.h"
#include "ends.h"
#include "gsl.h"
#include "nlopt_solvers.h"
#include "optimizers/classical.h"
#include "suite/harness/registry.h"
#include "suite/harness/study.h"

namespace libraries {
namespace {

using physinv::Experiment;
using physinv::Profile;

/// The suite's own as in the experiment, and each library's for as many
/// iterations.
std::vector<physinv::Method> methods(const physinv::Method& bfgs) {
  const Index limit = bfgs.chain.front()->default_iterations();
  return {
      bfgs,
      {"lbfgsb", {physinv::lbfgsb_solve({.iterations = limit})}},
      {"gsl-bfgs2", {gsl_bfgs2({.iterations = limit})}},
      {"nlopt-lbfgs", {nlopt_solve(NloptAlgorithm::lbfgs, limit)}},
      {"nlopt-slsqp", {nlopt_solve(NloptAlgorithm::slsqp, limit)}},
      {"nlopt-mma", {nlopt_solve(NloptAlgorithm::mma, limit)}},
      {"ceres-bfgs", {ceres_solve(CeresDirection::bfgs, limit)}},
      {"ceres-lbfgs", {ceres_solve(CeresDirection::lbfgs, limit)}},
      {"dlib-bfgs", {dlib_solve({.iterations = limit})}},
      {"dlib-lbfgs",
       {dlib_solve({.strategy = DlibStrategy::lbfgs, .iterations = limit})}}};
}

/// Of `smoke`, which takes seconds.
constexpr Index kFew = 8;

struct Problem {
  std::string name;
  Index smoke_size = kFew;  ///< problems at most
};

/// The rows in which the suite's BFGS runs, for all methods here; of `smoke`
/// those of few problems.
std::vector<Profile> profiles(const Experiment& of,
                              Index smoke_size,
                              const std::vector<physinv::Method>& methods) {
  std::vector<std::string> all;
  for (const auto& method : methods) all.push_back(method.id);
  std::vector<Profile> result;
  for (const Profile& profile : of.profiles) {
    Profile mine{.name = profile.name, .rows = {}};
    for (physinv::Row row : profile.rows) {
      if (std::ranges::find(row.methods, "bfgs") == row.methods.end()) continue;
      if (profile.name == "smoke") {
        std::erase_if(row.n, [](Index n) { return n > kFew; });
        for (Index& n : row.n) n = std::min(n, smoke_size);
      }
      if (row.n.empty()) continue;
      row.methods = all;
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
  const auto all = methods(*physinv::find_method(*base, "bfgs"));
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
