#include "suite/cases/hig/common/jacobian_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "optimizers/training.h"
#include "optimizers/training/jacobians_alone.h"
#include "suite/cases/hig/common/methods.h"
#include "suite/core/check.h"
#include "suite/evidence/update_time.h"

namespace physinv::hig {
namespace {

/// Of an experiment of the paper.
std::string name_of(const std::string& experiment) {
  return experiment + "-jacobians";
}

/// The columns of an optimizer in a table.
struct Batches {
  const char *optimizer, *title, *takes;
  std::vector<Index> sizes;

  /// "gradient-b256", "jacobians-b32"
  std::string method(Index batch) const {
    return takes + ("-b" + std::to_string(batch));
  }
};
Batches of_adam(std::vector<Index> sizes) {
  return {"adam", "Adam", "gradient", std::move(sizes)};
}
Batches of_hig(std::vector<Index> sizes) {
  return {"hig", "HIG", "jacobians", std::move(sizes)};
}

struct Timed {
  const char *experiment, *table, *key;
  Batches adam, hig;
  Index updates;
};
const std::vector<Timed> kTimed = {
    {"hig/oscillators",
     "Table 3",
     "table3",
     of_adam({256, 512, 1024}),
     of_hig({32, 64, 128}),
     200},
    {"hig/poisson", "Table 4", "table4", of_adam({64}), of_hig({64}), 200},
    {"hig/quantum-dipole",
     "Table 5",
     "table5",
     of_adam({256, 512, 1024}),
     of_hig({8, 16}),
     10}};

const Timed& timed_of(const std::string& experiment) {
  const auto at =
      std::find_if(kTimed.begin(), kTimed.end(), [&](const Timed& t) {
        return t.experiment == experiment;
      });
  SUITE_CHECK(at != kTimed.end(), "the paper must have a time for it");
  return *at;
}

constexpr RowOf row{.n = 16};

Method timed(const Batches& of, Index batch, SignalRecipe signal) {
  return {.id = of.method(batch),
          .chain = {train({.rule = SgdOptions{.rate = 0},
                           .batch = batch,
                           .fresh = true,
                           .signal = std::move(signal)})}};
}

Experiment experiment(Experiment e, const Timed& t) {
  e.name = name_of(e.name);
  e.title += ", time of the Jacobian";
  e.citation.where = t.table;
  e.claims.clear(), e.methods.clear(), e.report = {};
  for (const Index batch : t.adam.sizes)
    e.methods.push_back(timed(t.adam, batch, solver_loss()));
  for (const Index batch : t.hig.sizes)
    e.methods.push_back(timed(t.hig, batch, jacobians_alone()));
  std::vector<std::string> ids;
  for (const Method& m : e.methods) ids.push_back(m.id);
  e.profiles = {{.name = "paper", .rows = {row(ids, {0}, t.updates)}}};
  return e;
}

Section report(const Timed& t, const Evidence& e) {
  Table table{.id = "jacobians",
              .title = "Duration of the Jacobian",
              .where = t.table,
              .unit = "CPU ms",
              .digits = 3,
              .corner = "optimizer",
              .columns = {"Jacobian"}};
  TimedStages timed;
  for (const Batches& b : {t.adam, t.hig})
    for (const Index batch : b.sizes) {
      Cell cell = update_time(e, {b.method(batch)}, timed);
      if (const auto value = e.published.find(
              t.experiment,
              fmt::format("{}/{}/b={}/jacobian", t.key, b.optimizer, batch)))
        cell.paper = 1e3 * value->value;
      table.rows.push_back({.label = fmt::format("{}, b = {}", b.title, batch),
                            .cells = {std::move(cell)}});
    }
  table.note =
      "The gradient of a batch for Adam; for HIG the Jacobians of solver and "
      "outputs, the network's is not formed. " +
      timed.note() + " The paper's machine had a GPU.";
  return {.tables = {std::move(table)}};
}

}  // namespace

CostLine cost_line(const std::string& experiment,
                   std::string_view optimizer,
                   Index batch,
                   std::string method,
                   std::string label) {
  const Timed& t = timed_of(experiment);
  const Batches& of = optimizer == t.adam.optimizer ? t.adam : t.hig;
  return {.method = std::move(method),
          .label = std::move(label),
          .published = fmt::format("{}/{}/b={}", t.key, of.optimizer, batch),
          .jacobian = Select{of.method(batch)}.in(name_of(experiment))};
}

void add_jacobian_times(Registry& r, const std::string& name) {
  const auto of = r.find(name);
  SUITE_CHECK(of != nullptr, "the timed experiment must be registered before");
  r.add(experiment(*of, timed_of(name)));
}

void add_jacobian_report(Registry& r, const std::string& name) {
  r.add_report(name_of(name), std::bind_front(report, timed_of(name)));
}

}  // namespace physinv::hig
