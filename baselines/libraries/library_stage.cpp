#include "library_stage.h"

#include <utility>

#include "optimizers/minimize.h"

namespace libraries {

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
      physinv::chained(std::move(facts.options),
                       physinv::describe("evaluations", facts.evaluations));
  return physinv::make_stage(
      {.name = "solve",
       .needs = physinv::Needs::forward | physinv::Needs::vjp,
       .options = std::move(options),
       .iterations = facts.iterations,
       .networks = physinv::Networks::none,
       .operations = operations,
       .source = source},
      [make = std::move(make),
       budget = facts.evaluations](physinv::StageRun& run) {
        LibrarySolver solver(make(run.setting.gtol), run.iterations, budget);
        auto out = physinv::minimize(solver, run, run.oracle.start());
        solver.report(out);
        return out;
      });
}

}  // namespace libraries
