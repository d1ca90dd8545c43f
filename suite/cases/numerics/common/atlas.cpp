#include "suite/cases/numerics/common/atlas.h"

#include <cmath>
#include <utility>

#include "suite/diagnostics/stability_sweep.h"
#include "suite/harness/registry.h"

namespace physinv {
namespace {

constexpr const char* kMethod = "stability";

std::shared_ptr<const Stage> stage_of(const Sweep& sweep) {
  StabilitySweepOptions options{.name = sweep.id,
                                .problems = sweep.problems,
                                .points = {},
                                .zero = sweep.zero,
                                .examples = sweep.examples};
  for (std::size_t k = 0; k < sweep.y.values.size(); ++k)
    for (const double x : sweep.x.values)
      options.points.push_back(
          {sweep.problems.size() == 1 ? 0 : static_cast<Index>(k),
           sweep.point(x, sweep.y.values[k])});
  return stability_sweep(options);
}

std::vector<Atlas>& all_atlases() {
  static std::vector<Atlas> all;
  return all;
}

}  // namespace

const std::vector<Atlas>& atlases() { return all_atlases(); }

std::vector<ProblemRecipe> along(
    const SweepAxis& axis,
    const std::function<ProblemRecipe(double)>& problem) {
  std::vector<ProblemRecipe> all;
  for (const double value : axis.values) all.push_back(problem(value));
  return all;
}

Vector<double> uneven(Index rows, double size) {
  return Vector<double>::NullaryExpr(
      rows, [=](Index k) { return size * std::cos(1.1 * double(k)); });
}

bool register_atlas(Atlas atlas) {
  Method method{kMethod, {}};
  std::vector<std::string> stages;
  for (const Sweep& sweep : atlas.sweeps) {
    method.chain.push_back(stage_of(sweep));
    stages.push_back(sweep.id);
  }
  const std::vector<Row> rows = {
      {.methods = {kMethod}, .n = {1}, .seeds = {0}}};
  all_atlases().push_back(atlas);
  const ProblemRecipe problem = atlas.problem.make_double
                                    ? atlas.problem
                                    : atlas.sweeps.front().problems.front();
  const auto report = [name = atlas.name, sweeps = std::move(atlas.sweeps)](
                          const Results& results, const Published&) {
    Section section;
    for (const Sweep& s : sweeps) {
      const auto* found = find_sweep(results, name, kMethod, s.id);
      section.tables.push_back(sweep_table(s.id, s.title, found));
      section.figures.push_back(sweep_maps(s.id, s.title, s.x, s.y, found));
    }
    return section;
  };
  return register_experiment({
      .name = atlas.name,
      .title = atlas.title,
      .source = atlas.source,
      .problem = problem,
      .setting = {},  // nothing is learned here
      .profiles = {{.name = "smoke", .rows = rows},
                   {.name = "quick", .rows = rows},
                   {.name = "standard", .rows = rows},
                   {.name = "paper", .rows = rows}},
      .methods = {method},
      .claims = {adjoint_claim("N1", stages)},
      .report = report,
  });
}

}  // namespace physinv
