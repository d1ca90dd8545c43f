#include "suite/cases/numerics/common/atlas.h"

#include <cmath>
#include <utility>

#include "suite/cases/numerics/common/sweep_report.h"
#include "suite/core/math.h"
#include "suite/diagnostics/stability_sweep.h"

namespace physinv {
namespace {

/// Of a parameter that names no number.
constexpr Index kSamples = 4;

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
           [point = sweep.point, x, y = sweep.y.values[k]] {
             return point(x, y);
           }});
  return stability_sweep(options);
}

std::vector<Atlas>& all_atlases() {
  static std::vector<Atlas> all;
  return all;
}

}  // namespace

const std::vector<Atlas>& atlases() { return all_atlases(); }

Vector<double> uneven(Index rows, double size) {
  return Vector<double>::NullaryExpr(
      rows, [=](Index k) { return size * math::cos(1.1 * double(k)); });
}

void add_atlas(Registry& r, Atlas atlas) {
  Method method{kStability, {}};
  std::vector<std::string> stages;
  for (const Sweep& sweep : atlas.sweeps) {
    method.chain.push_back(stage_of(sweep));
    stages.push_back(sweep.id);
  }
  std::vector<Row> rows = {{.methods = {kStability}, .n = {1}, .seeds = {0}}};
  std::vector<Method> methods = {std::move(method)};
  std::vector<Claim> claims = {adjoint_claim("N1", stages)};
  if (!atlas.parameters.empty()) {
    for (const Row& row : accuracy_rows(kSamples)) rows.push_back(row);
    const auto& parameters = declare_parameters(atlas.name, atlas.parameters);
    methods.push_back(accuracy_method(parameters));
    for (Claim& claim : order_claims(parameters))
      claims.push_back(std::move(claim));
  }
  all_atlases().push_back(atlas);
  const ProblemRecipe problem = atlas.problem.make_double
                                    ? atlas.problem
                                    : atlas.sweeps.front().problems.front();
  const auto report = [sweeps = std::move(atlas.sweeps)](const Evidence& e) {
    Section section;
    add_accuracy(section, e);
    for (const Sweep& s : sweeps) {
      const auto* found = find_sweep(e, s.id);
      section.tables.push_back(sweep_table(s.id, s.title, found));
      section.figures.push_back(sweep_maps(s.id, s.title, s.x, s.y, found));
    }
    return section;
  };
  r.add(Experiment{
      .name = atlas.name,
      .title = atlas.title,
      .citation = atlas.citation,
      .problem = problem,
      .setting = {},  // nothing is learned here
      .profiles = {{.name = "smoke", .rows = rows},
                   {.name = "quick", .rows = rows},
                   {.name = "standard", .rows = rows},
                   {.name = "paper", .rows = rows}},
      .methods = std::move(methods),
      .claims = std::move(claims),
      .report = report,
  });
}

}  // namespace physinv
