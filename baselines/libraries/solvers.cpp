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

std::vector<physinv::Method> solvers(const physinv::Experiment& base) {
  const physinv::Method& bfgs = *physinv::find_method(base, "bfgs");
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
