// HIG paper, Tables 3 to 5: how long the Jacobian of an update takes. Adam's is
// the gradient of the batch, that of half-inverse gradients the Jacobians of
// solver and outputs; the network's own is never formed here. Updates of a rate
// of zero take nothing else.
#include <string>
#include <utility>
#include <vector>

#include "optimizers/training.h"
#include "suite/cases/hig/common/methods.h"
#include "suite/cases/hig/jacobian_times/jacobian_times.h"
#include "suite/cases/hig/jacobian_times/jacobians_alone.h"
#include "suite/core/check.h"
#include "suite/harness/registry.h"

namespace physinv::hig::jacobian_times {
namespace {

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

}  // namespace

void add_experiments(Registry& r) {
  for (const Timed& t : kTimed) {
    const auto of = r.find(t.experiment);
    SUITE_CHECK(of != nullptr, "what is timed is registered before");
    r.add(experiment(*of, t));
  }
}

}  // namespace physinv::hig::jacobian_times
