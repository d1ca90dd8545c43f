#include "suite/harness/case.h"

#include <fmt/format.h>

#include <algorithm>

namespace physinv {
namespace {

bool has_precision(const Method& method) {
  return std::any_of(method.chain.begin(),
                     method.chain.end(),
                     [](const auto& stage) { return stage->has_precision(); });
}

/// The name, from everything else.
void complete(Case& c) {
  const CaseInfo& i = c.info;
  c.info.name = fmt::format("{}/{}/n={}", i.experiment, i.method, i.n);
  if (has_precision(*c.method) && i.precision == Precision::f64)
    c.info.name += "/precision=f64";
  c.info.name += fmt::format("/seed={}", i.seed);
}

}  // namespace

const Method* find_method(const Experiment& e, std::string_view id) {
  for (const Method& m : e.methods)
    if (m.id == id) return &m;
  return nullptr;
}

CaseSize size_of(const Experiment& e) {
  const auto problem = e.problem.make<double>();
  CaseSize size{};
  size.shape = problem->shape();
  size.problem_operations = problem->operations();
  const auto operations = [&](const NetworkRole& role, Index outputs) {
    if (!role.recipe.make_float) return 0.0;
    Index inputs = 0;
    for (const Field f : role.inputs) {
      inputs += f == Field::unknowns ? size.shape.unknowns
                : f == Field::given  ? size.shape.given
                                     : size.shape.observations;
    }
    return role.recipe.make<float>(inputs, outputs)->operations();
  };
  size.predictor_operations =
      operations(e.setting.predictor, size.shape.unknowns);
  size.surrogate_operations =
      operations(e.setting.surrogate, size.shape.observations);
  return size;
}

Case declared_case(const std::shared_ptr<const Experiment>& e,
                   const Method& method,
                   const std::string& profile,
                   const Row& row,
                   Index n,
                   std::uint64_t seed,
                   const std::shared_future<CaseSize>& size) {
  Case c;
  c.size = size;
  c.experiment = e;
  c.method = &method;
  c.info.experiment = e->name;
  c.info.method = method.id;
  c.info.profile = profile;
  c.info.n = n;
  c.info.seed = seed;
  c.info.about.problem = e->problem.name;
  const Quantities& of = e->problem.quantities;
  c.info.about.unknowns = {of.unknowns.names, of.unknowns.unit};
  c.info.about.observations = {of.observations.names, of.observations.unit};
  c.info.about.given = {of.given.names, of.given.unit};
  c.info.precision = has_precision(method) ? row.precision : Precision::f64;
  for (const auto& stage : method.chain) {
    c.info.stages.push_back(stage->name());
    c.stage_iterations.push_back(stage->takes_row_iterations() &&
                                         row.iterations > 0
                                     ? row.iterations
                                     : stage->default_iterations());
  }
  complete(c);
  return c;
}

Case resized(const Case& c, Index n, std::vector<Index> iterations) {
  Case out = c;
  out.info.n = n;
  out.info.keys.clear();
  out.stage_iterations = std::move(iterations);
  complete(out);
  return out;
}

double Case::operations(std::size_t stage) const {
  CaseSize of_stage = size.get();
  of_stage.n = info.n;
  of_stage.iterations = stage_iterations[stage];
  return method->chain[stage]->operations(of_stage);
}

double Case::operations() const {
  double all = 0;
  for (std::size_t k = 0; k < method->chain.size(); ++k) all += operations(k);
  return all;
}

}  // namespace physinv
