#include "library_stage.h"

#include <stdexcept>
#include <utility>

#include "optimizers/minimize.h"

namespace libraries {
namespace {

/// Throws at its evaluation number `at`, and at all later ones.
class Interrupted final : public Objective {
 public:
  Interrupted(Objective& objective, Index at)
      : objective_(objective), left_(at) {}
  double evaluate(const double* x, double* gradient) override {
    if (--left_ <= 0) throw std::domain_error("the objective threw");
    return objective_.evaluate(x, gradient);
  }
  void iterate(const double* x) override { objective_.iterate(x); }

 private:
  Objective& objective_;
  Index left_;
};

Library interrupted(Library library, Index at) {
  return [=](Objective& f, const Vector<double>& x0, Index iterations) {
    Interrupted objective(f, at);
    return library(objective, x0, iterations);
  };
}

}  // namespace

std::shared_ptr<const physinv::Stage> library_solve(
    LibraryFacts facts,
    std::function<Library(double gtol)> make,
    const char* source) {
  // Tens of evaluations are typical, each on a fiber.
  const auto operations = [](const physinv::CaseSize& size) {
    const auto d = static_cast<double>(size.shape.unknowns);
    return 40.0 * static_cast<double>(size.n) *
           (3 * size.problem_operations + 1000 + 20 * d);
  };
  physinv::Options options =
      physinv::chained(std::move(facts.options), physinv::describe(facts.task));
  return physinv::make_stage(
      {.name = "solve",
       .needs = physinv::Needs::forward | physinv::Needs::vjp,
       .options = std::move(options),
       .iterations = facts.task.iterations,
       .networks = physinv::Networks::none,
       .operations = operations,
       .source = source},
      [make = std::move(make), asked = facts.task](physinv::StageRun& run) {
        Task task = asked;
        task.iterations = run.iterations;
        Library library = make(run.setting.gtol);
        if (task.throws_at > 0)
          library = interrupted(std::move(library), task.throws_at);
        LibrarySolver solver(std::move(library), task);
        auto out = physinv::minimize(solver, run, run.oracle.start());
        solver.report(out);
        return out;
      });
}

}  // namespace libraries
