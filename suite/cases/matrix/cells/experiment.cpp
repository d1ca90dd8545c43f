// Every method on every problem that can carry it, which none of the papers
// has.
#include "suite/cases/matrix/cells/own.h"
#include "suite/harness/registry.h"

namespace physinv::matrix {
namespace {

Method method(const MatrixMethod& m, const MatrixProblem& p) {
  TrainingOptions options = m.options;
  options.batch = p.batch;
  options.iterations = p.updates;
  return {.id = m.id,
          .chain = {train_at_best_rate(options, {.rates = m.rates})}};
}

}  // namespace

Experiment experiment(const MatrixProblem& p) {
  std::vector<Method> able;
  std::vector<std::string> ids, few;
  for (const MatrixMethod& m : methods()) {
    if (!refusal(p, m).empty()) continue;
    able.push_back(method(m, p));
    ids.push_back(m.id);
    if (m.id == "adam" || m.id == "sip") few.push_back(m.id);
  }
  const auto full = row(ids, p.n, 3, p.updates);
  return {.name = p.experiment(),
          .title = p.title,
          .citation = {},
          .problem = p.problem,
          .setting = p.setting,
          .profiles = {{.name = "smoke", .rows = {row(few, 4, 1, 2)}},
                       {.name = "quick",
                        .rows = {row(ids, p.n, 1, p.updates / 10)}},
                       {.name = "standard", .rows = {full}},
                       {.name = "paper", .rows = {full}}},
          .methods = std::move(able)};
}

void add_experiments(Registry& r) {
  for (const MatrixProblem& p : problems()) r.add(experiment(p));
}

}  // namespace physinv::matrix
