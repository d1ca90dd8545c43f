// The chapter "Scale-invariance and inversion": steps that know more or less of
// two small problems. Two experiments, as each toy is a separate problem.
#include <string>
#include <utility>
#include <vector>

#include "optimizers/local_steps.h"
#include "problems/scaling/scaling.h"
#include "suite/cases/physgrad/scaling/scaling.h"
#include "suite/harness/registry.h"

namespace physinv::scaling {
namespace {

using enum LocalStep;
using Ids = std::vector<std::string>;

/// Problems whose paths the figures draw.
constexpr Index kPaths = 6;

Method method(std::string id,
              LocalStep step,
              double rate,
              NumericInverseOptions search = {}) {
  return {
      .id = std::move(id),
      .chain = {local_steps(
          {.step = step, .rate = rate, .paths = kPaths, .search = search})}};
}

/// The chapter leaves these to its readers.
Method ruled(std::string id, StepOptions rule) {
  return {.id = std::move(id),
          .chain = {local_steps({.paths = kPaths, .rule = std::move(rule)})}};
}

Row row(Ids ids, Index n, Index steps) {
  return physinv::row(std::move(ids), n, 1, steps, Precision::f64);
}

std::vector<Profile> profiles(const std::vector<Row>& smoke,
                              const std::vector<Row>& all) {
  const auto with = [](std::vector<Row> rows, const char* id) {
    rows.push_back(row({id}, 1, 1));
    return rows;
  };
  return {{.name = "smoke", .rows = with(smoke, "batch_1e3")},
          {.name = "quick", .rows = with(all, "batch_1e5")},
          {.name = "standard", .rows = with(all, "batch_1e5")},
          {.name = "paper", .rows = with(all, "batch_1e6")}};
}

void add_batches(Experiment& e, int power) {
  e.methods.push_back(batch("batch_1e3", power, 1000));
  e.methods.push_back(batch("batch_1e5", power, 100'000));
  e.methods.push_back(batch("batch_1e6", power, 1'000'000));
}

// ---- y = (x1, alpha x2) -----------------------------------------------------

const Ids kInvariant = {"newton", "ig", "pg"};

/// Gradient descent at 0.05 is fine for alpha = 1 and diverges for 5.
Experiment scaling() {
  const auto rows = [](Index all, Index steps) {
    return std::vector<Row>{row({"gd", "gd_large"}, 3, steps),
                            row(kInvariant, all, steps)};
  };
  Experiment e{
      .name = kScaling,
      .title = "Scaling",
      .citation = {.paper = "physgrad", .where = "Crux of the matter"},
      .problem = problems::scaling({.scales = {1, 3, 5, 1e-3, 1e3, 1e6}}),
      .profiles = profiles(rows(3, 10), rows(6, 50)),
      .methods = {method("gd", gradient, 0.03),
                  method("gd_large", gradient, 0.05),
                  method("newton", newton, kRate),
                  method("ig", inverse_gradient, kRate),
                  method("pg", inverse_simulator, kRate)}};
  add_batches(e, 1);
  return e;
}

// ---- y = (x1, x2^2) ---------------------------------------------------------

/// The second half are the rates of the authors' figure.
std::vector<Method> comparison_methods() {
  return {method("gd", gradient, 0.01),
          method("newton", newton, 1.0 / 3),
          method("ig", inverse_gradient, kRate),
          method("pg", inverse_simulator, kRate),
          method("pg_numeric", inverse_search, kRate, {.difference = 1e-8}),
          method("pg_numeric_exact",
                 inverse_search,
                 kRate,
                 {.pgtol = 1e-10, .ftol = 0}),
          {.id = "identities", .chain = {identities()}},
          method("newton_large", newton, 0.5),
          method("newton_small", newton, 0.1),
          method("pg_small", inverse_simulator, 0.05),
          method("gd_large", gradient, 0.5 / 36),
          method("gd_small", gradient, 0.005),
          ruled("adam", AdamOptions{.rate = 0.1, .eps = 1e-8}),
          ruled("adagrad",
                AdagradOptions{.rate = 0.1, .accumulator = 0, .eps = 1e-10}),
          ruled("rmsprop",
                RmspropOptions{.rate = 0.1, .decay = 0.99, .eps = 1e-8})};
}

Experiment comparison() {
  const Row ten = row({"gd",
                       "newton",
                       "ig",
                       "pg",
                       "pg_numeric",
                       "pg_numeric_exact",
                       "identities"},
                      1,
                      10);
  const std::vector<Row> all = {
      ten,
      row({"newton_large", "gd_large"}, 1, 10),
      row({"newton_small", "pg_small", "adam", "adagrad", "rmsprop"}, 1, 100),
      row({"gd_small"}, 1, 1000)};
  Experiment e{
      .name = kComparison,
      .title = "Comparison",
      .citation = {.paper = "physgrad", .where = "notebook of the chapter"},
      .problem = problems::scaling({.power = 2, .start = {3, 3}}),
      .profiles = profiles({ten}, all),
      .methods = comparison_methods()};
  add_batches(e, 2);
  return e;
}

}  // namespace

void add_experiments(Registry& r) {
  r.add(scaling());
  r.add(comparison());
}

}  // namespace physinv::scaling
