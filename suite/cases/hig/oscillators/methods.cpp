#include "suite/cases/hig/oscillators/methods.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "optimizers/training.h"
#include "suite/cases/hig/common/methods.h"

namespace physinv::oscillators {
namespace {

Method by_rule(std::string id, Index batch, StepOptions rule) {
  return {.id = std::move(id),
          .chain = {train({.rule = std::move(rule), .batch = batch})}};
}

Method by_power(std::string id, Index batch, hig::Power power) {
  return {.id = std::move(id),
          .chain = {train({.rule = HalfInverseStepOptions{.power = power},
                           .batch = batch})}};
}

StepOptions first_order(std::string_view rule, double rate) {
  if (rule == "adadelta") return AdadeltaOptions{.rate = rate};
  if (rule == "adagrad") return AdagradOptions{.rate = rate};
  if (rule == "sgd") return SgdOptions{.rate = rate};
  if (rule == "rmsprop") return RmspropOptions{.rate = rate};
  return AdamOptions{.rate = rate, .eps_before_correction = true};
}

}  // namespace

std::string grid_id(const char* rule, double rate, Index batch) {
  return fmt::format("grid-{}-{}-b{}", rule, rate_id(rate), batch);
}

std::vector<Method> methods() {
  std::vector<Method> all = {
      by_power("hig", 128, {.kappa = -0.5, .tau = 1e-6}),
      by_power("gn", 128, {.kappa = -1, .tau = 1e-6}),
      by_rule("adam", 512, first_order("adam", 3e-4)),
      by_rule("sgd", 512, first_order("sgd", 0.1)),
      by_rule("adagrad", 512, first_order("adagrad", 0.1)),
      by_rule("adadelta", 512, first_order("adadelta", 0.1)),
      by_rule("rmsprop", 512, first_order("rmsprop", 1e-4)),
      by_rule("adam-b256", 256, first_order("adam", 3e-4)),
      by_rule("adam-b1024", 1024, first_order("adam", 3e-4)),
      by_power("hig-b32", 32, {.kappa = -0.5, .tau = 1e-6}),
      by_power("gn-b32", 32, {.kappa = -1, .tau = 1e-6})};
  for (const Exponent& e : kExponents)
    all.push_back(by_power(e.id, 64, {.kappa = e.kappa, .tau = 1e-6}));
  for (const int digits : {5, 7, 8, 9, 10}) {
    const double tau = std::pow(10.0, -digits);
    all.push_back(by_power(
        fmt::format("hig-tau{}", digits), 64, {.kappa = -0.5, .tau = tau}));
    all.push_back(by_power(
        fmt::format("gn-tau{}", digits), 64, {.kappa = -1, .tau = tau}));
  }
  for (const int thousandths : {125, 250, 375, 500}) {
    all.push_back(
        by_power(fmt::format("beta-m{}", thousandths),
                 64,
                 {.kappa = -0.5, .tau = 1e-6, .beta = -thousandths / 1000.0}));
  }
  for (const Grid& grid : kGrids)
    for (const double rate : grid.rates)
      for (const Index batch : kGridBatches)
        all.push_back(by_rule(grid_id(grid.rule, rate, batch),
                              batch,
                              first_order(grid.rule, rate)));
  return all;
}

std::vector<std::string> ids_with(const std::string& beginning) {
  std::vector<std::string> ids;
  for (const Method& m : methods())
    if (m.id.starts_with(beginning)) ids.push_back(m.id);
  return ids;
}

}  // namespace physinv::oscillators
