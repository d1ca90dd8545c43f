// HIG paper, App. C, Figs. 12 and 13: the size of the batch is not printed.
#include <vector>

#include "optimizers/training.h"
#include "suite/cases/hig/common/methods.h"
#include "suite/cases/hig/oscillators/ablation.h"
#include "suite/core/check.h"
#include "suite/harness/registry.h"
#include "suite/harness/study.h"

namespace physinv::oscillators::ablation_batch {
namespace {

constexpr RowOf row{.n = 4096};
constexpr Index kUpdates = 2000;

Experiment experiment(Experiment e, Index batch) {
  e.name = study_of(batch);
  e.title += fmt::format(", batches of {}", batch);
  e.citation.where = "App. C, Figs. 12, 13";
  e.claims.clear(), e.methods.clear(), e.report = {};
  std::vector<std::string> ids;
  for (const auto& p : ablation_points()) {
    const HalfInverseStepOptions rule{.power = p.power};
    e.methods.push_back(
        {.id = p.id, .chain = {train({.rule = rule, .batch = batch})}});
    ids.push_back(p.id);
  }
  e.profiles = {{.name = "study", .rows = {row(ids, {0}, kUpdates)}}};
  return e;
}

}  // namespace

void add_experiments(Registry& r) {
  const auto varied = r.find(kName);
  SUITE_CHECK(varied != nullptr,
              "the varied experiment must be registered before");
  for (const Index batch : kAblationBatches) {
    register_study(study_of(batch), kName);
    r.add(experiment(*varied, batch));
  }
}

}  // namespace physinv::oscillators::ablation_batch
