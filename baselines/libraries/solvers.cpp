#include "solvers.h"

#include <algorithm>
#include <utility>

#include "ceres_solvers.h"
#include "dlib_solvers.h"
#include "gsl.h"
#include "nlopt_solvers.h"
#include "optimizers/classical.h"
#include "suite/harness/registry.h"

namespace libraries {

using physinv::Profile;
using physinv::Row;

namespace {

Index limit_of(const physinv::Method& bfgs) {
  return bfgs.chain.front()->default_iterations();
}

}  // namespace

std::vector<physinv::Method> solvers(const Task& task) {
  return {
      {"bfgs", {physinv::bfgs_solve({.iterations = task.iterations})}},
      {"lbfgsb",
       {physinv::lbfgsb_solve({.iterations = task.iterations,
                               .lower = task.lower,
                               .upper = task.upper})}},
      {"gsl-bfgs2", {gsl_bfgs2(task)}},
      {"nlopt-lbfgs", {nlopt_solve(NloptAlgorithm::lbfgs, task)}},
      {"nlopt-slsqp", {nlopt_solve(NloptAlgorithm::slsqp, task)}},
      {"nlopt-mma", {nlopt_solve(NloptAlgorithm::mma, task)}},
      {"ceres-bfgs", {ceres_solve(CeresDirection::bfgs, task)}},
      {"ceres-lbfgs", {ceres_solve(CeresDirection::lbfgs, task)}},
      {"dlib-bfgs", {dlib_solve(task)}},
      {"dlib-lbfgs", {dlib_solve(task, {.strategy = DlibStrategy::lbfgs})}}};
}

std::vector<physinv::Method> solvers(const physinv::Experiment& base) {
  const physinv::Method& bfgs = *physinv::find_method(base, "bfgs");
  auto all = solvers({.iterations = limit_of(bfgs)});
  all.front() = bfgs;
  return all;
}

std::vector<physinv::Method> bfgs_settings(const physinv::Experiment& base) {
  using physinv::FirstTrial;
  const Index limit = limit_of(*physinv::find_method(base, "bfgs"));
  std::vector<physinv::Method> all;
  const auto add = [&](const char* id, physinv::BfgsStageOptions options) {
    options.iterations = limit;
    all.push_back({id, {physinv::bfgs_solve(options)}});
  };
  add("bfgs-shorter", {.first_trial = FirstTrial::shorter});
  add("bfgs-gradient", {.first_trial = FirstTrial::gradient});
  add("bfgs-tenth-gradient", {.first_trial = FirstTrial::tenth_gradient});
  add("bfgs-length-1", {.first_trial = FirstTrial::length_1});
  add("bfgs-length-tenth", {.first_trial = FirstTrial::length_tenth});
  add("bfgs-back-off", {.back_off = true});
  add("bfgs-gradient-back-off",
      {.first_trial = FirstTrial::gradient, .back_off = true});
  return all;
}

std::vector<std::string> ids(const std::vector<physinv::Method>& methods) {
  std::vector<std::string> all;
  for (const auto& method : methods) all.push_back(method.id);
  return all;
}

std::vector<Profile> profiles_with(
    const physinv::Experiment& of,
    const char* method,
    const std::function<std::vector<Row>(const Profile&, Row)>& make) {
  std::vector<Profile> all;
  for (const Profile& profile : of.profiles) {
    Profile mine{.name = profile.name, .rows = {}};
    for (const Row& row : profile.rows) {
      if (std::ranges::find(row.methods, method) == row.methods.end()) continue;
      for (Row& one : make(profile, row)) mine.rows.push_back(std::move(one));
    }
    if (!mine.rows.empty()) all.push_back(std::move(mine));
  }
  return all;
}

}  // namespace libraries
