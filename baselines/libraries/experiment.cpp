// Experiments `libraries/<problem>`: problems, starts and sizes of the suite's
// own, solved by the suite's optimizers and by those of other libraries.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "gsl.h"
#include "optimizers/classical.h"
#include "suite/harness/registry.h"
#include "suite/harness/study.h"

namespace libraries {
namespace {

using physinv::Experiment;
using physinv::Profile;

std::vector<physinv::Method> methods() {
  return {{"bfgs", {physinv::bfgs_solve()}},
          {"lbfgsb", {physinv::lbfgsb_solve()}},
          {"gsl-bfgs2", {gsl_bfgs2()}}};
}

/// The rows in which the suite's BFGS runs, for all methods here.
std::vector<Profile> profiles(const Experiment& of) {
  std::vector<std::string> all;
  for (const auto& method : methods()) all.push_back(method.id);
  std::vector<Profile> result;
  for (const Profile& profile : of.profiles) {
    Profile mine{.name = profile.name, .rows = {}};
    for (physinv::Row row : profile.rows) {
      if (std::ranges::find(row.methods, "bfgs") == row.methods.end()) continue;
      row.methods = all;
      mine.rows.push_back(std::move(row));
    }
    if (!mine.rows.empty()) result.push_back(std::move(mine));
  }
  return result;
}

/// Programs over one folder of experiments, and contract tests, lack some.
void add(const std::string& problem, const std::string& of) {
  const auto base = physinv::registry().find(of);
  if (base == nullptr) return;
  const std::string name = "libraries/" + problem;
  physinv::register_study(name, of);  // the same problems
  physinv::register_experiment({.name = name,
                                .title = base->title + ", other libraries",
                                .citation = base->citation,
                                .problem = base->problem,
                                .setting = base->setting,
                                .profiles = profiles(*base),
                                .methods = methods(),
                                .styles = base->styles});
}

const bool kRegistered = [] {
  add("wave-packet", "jpo/wave-packet");
  return true;
}();

}  // namespace
}  // namespace libraries
