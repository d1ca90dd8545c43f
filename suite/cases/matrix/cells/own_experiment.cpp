#include "baselines/neural_adjoint.h"
#include "baselines/supervised.h"
#include "baselines/surrogate.h"
#include "optimizers/classical.h"
#include "optimizers/jpo.h"
#include "suite/cases/matrix/cells/own.h"
#include "suite/nn/mlp.h"

namespace physinv::matrix {
namespace {

using Names = std::vector<std::string>;

constexpr Index kSmoke = 4;          // problems
constexpr Index kSmokeUpdates = 50;  // of networks and of gradient descent

/// Without a gradient nothing refines what a network estimates.
std::vector<std::shared_ptr<const Stage>> refined(
    std::vector<std::shared_ptr<const Stage>> chain,
    const ProblemRecipe& problem) {
  if (contains(problem.provided, Needs::vjp)) chain.push_back(bfgs_refine());
  return chain;
}

std::vector<Method> classical() {
  return {{"bfgs", {bfgs_solve()}},
          {"lbfgsb", {lbfgsb_solve({.iterations = 1000})}},
          {"gd", {gradient_descent_solve()}}};
}

std::vector<Method> networks(const ProblemRecipe& problem, Index iterations) {
  return {{"jpo",
           refined({jpo_fit({.step = AdamOptions{.rate = 1e-3},
                             .iterations = iterations})},
                   problem)},
          {"supervised",
           refined({supervised_fit({.iterations = iterations})}, problem)},
          {"na",
           refined({surrogate_fit({.iterations = iterations}),
                    neural_adjoint_solve()},
                   problem)}};
}

/// Adds those that the problem can carry; returns their names.
Names add_able(Experiment& e, const std::vector<Method>& methods) {
  Names able;
  for (const Method& m : methods) {
    if (!contains(e.problem.provided, m.needs())) continue;
    able.push_back(m.id);
    e.methods.push_back(m);
  }
  return able;
}

/// In front of the matrix's own rows.
void add_rows(Profile& profile,
              const Names& methods,
              Index n,
              std::uint64_t seeds,
              Index iterations = 0) {
  if (!methods.empty())
    profile.rows.push_back(row(methods, n, seeds, iterations));
}

}  // namespace

MatrixProblem own_row(const OwnOptions& o) {
  std::vector<Field> seen = {Field::observations}, moved = {Field::unknowns};
  if (o.shape.given > 0) {
    seen.insert(seen.begin(), Field::given);
    moved.push_back(Field::given);
  }
  const auto layers = nn::mlp({.hidden = o.hidden});
  return {.id = o.name,
          .title = o.title,
          .problem = o.problem,
          .setting = {.predictor = {seen, layers},
                      .surrogate = {moved, layers},
                      .gtol = o.gtol},
          .batch = o.batch,
          .updates = o.updates,
          .n = o.n};
}

Experiment own_experiment(const OwnOptions& o) {
  const MatrixProblem cell = own_row(o);
  Experiment e = experiment(cell);
  std::vector<Method> of_matrix = std::move(e.methods);
  e.methods.clear();
  const Names solvers = add_able(e, classical()),
              trained = add_able(e, networks(o.problem, o.iterations));
  for (Method& m : of_matrix) e.methods.push_back(std::move(m));
  for (Profile& p : e.profiles) {
    std::vector<Row> matrix = std::move(p.rows);
    p.rows.clear();
    if (p.name == "smoke") {
      add_rows(p, solvers, kSmoke, 1, kSmokeUpdates);
      add_rows(p, trained, kSmoke, 1, kSmokeUpdates);
    } else {
      const std::uint64_t seeds = p.name == "quick" ? 1 : 3;
      add_rows(p, solvers, o.n, seeds);
      add_rows(p, trained, o.n, seeds, o.iterations);
    }
    std::erase_if(matrix, [](const Row& r) { return r.methods.empty(); });
    p.rows = joined(std::move(p.rows), matrix);
  }
  e.styles = {{"bfgs", {Hue::blue, Marker::circle}},
              {"jpo", {Hue::orange, Marker::square}},
              {"supervised", {Hue::green, Marker::triangle}},
              {"na", {Hue::red, Marker::diamond}},
              {"gd", {Hue::purple, Marker::down}}};
  e.report = [cell](const Evidence& evidence) {
    return own_report(cell, evidence);
  };
  return e;
}

std::vector<std::pair<std::string, std::string>> skipped_methods(
    const MatrixProblem& problem) {
  std::vector<std::pair<std::string, std::string>> skipped;
  auto own = classical();
  for (Method& m : networks(problem.problem, 1)) own.push_back(std::move(m));
  for (const Method& m : own)
    if (!contains(problem.problem.provided, m.needs()))
      skipped.emplace_back(m.id, "no gradient");
  for (const MatrixMethod& m : methods())
    if (auto why = refusal(problem, m); !why.empty())
      skipped.emplace_back(m.id, std::move(why));
  return skipped;
}

}  // namespace physinv::matrix
