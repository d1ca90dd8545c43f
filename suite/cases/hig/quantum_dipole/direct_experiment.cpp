// HIG paper, Fig. 4b's floor: the quantum dipole's control optimised without a
// network, in double and in float.
#include <string>
#include <vector>

#include "optimizers/half_inverse_direct.h"
#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/cases/hig/quantum_dipole/grids.h"
#include "suite/cases/hig/quantum_dipole/metrics.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"

namespace physinv::dipole {
namespace {

Method method(std::string id, double kappa, double tau = 1e-5) {
  return {.id = std::move(id),
          .chain = {half_inverse_direct({.power = {.kappa = kappa, .tau = tau},
                                         .rate = 0.5,
                                         .metrics = losses_in_float()})}};
}

// ---- report -----------------------------------------------------------------

const std::vector<MethodLine> kLines = {
    {"hig", "HIG", Hue::orange},
    {"gn", "Gauss-Newton", Hue::blue},
    {"hig-f32", "HIG, float", Hue::purple},
    {"gn-f32", "Gauss-Newton, float", Hue::green},
    {"hig-tau7", "HIG, tau=1e-7", Hue::red},
    {"hig-f32-tau7", "HIG, float, tau=1e-7"}};

Section report(const Evidence& e) {
  Section section{.tables = {loss_table(e, kLines)},
                  .method_titles = titles_of(kLines)};
  LearningCurves curves(e, section);
  curves.losses(kLines, "loss", "Loss, evaluated in double", "Fig. 4b");
  curves.metric(kLines,
                kOverlap,
                "1 - |<t, psi>|^2 in float",
                "overlap",
                "The formula that cancels, in float",
                "Fig. 4b");
  curves.metric(kLines,
                kRest,
                "|psi - <t, psi> t|^2 in float",
                "rest",
                "The formula that does not cancel, in float",
                "Fig. 4b");
  return section;
}

std::vector<Row> rows(std::uint64_t seeds,
                      Index updates,
                      const std::vector<std::string>& in_double,
                      const std::vector<std::string>& in_float) {
  return {row(in_double, 16, seeds, updates, Precision::f64),
          row(in_float, 16, seeds, updates, Precision::f32)};
}

std::vector<Row> few(std::uint64_t seeds, Index updates) {
  return rows(seeds, updates, {"hig", "gn"}, {"hig-f32", "gn-f32"});
}
std::vector<Row> all(std::uint64_t seeds, Index updates) {
  return rows(seeds,
              updates,
              {"hig", "gn", "hig-tau7"},
              {"hig-f32", "gn-f32", "hig-f32-tau7"});
}

}  // namespace

void add_direct_experiment(Registry& r) {
  r.add(Experiment{
      .name = kDirect,
      .title = "Quantum dipole, control without a network",
      .citation = {.paper = "hig", .where = "Sec. 3.3, Fig. 4b"},
      .problem = problems::quantum_dipole({.angles = {0.7, 2}}),
      .setting = {.recorded = 16},
      .profiles = {{.name = "smoke", .rows = few(1, 20)},
                   {.name = "quick", .rows = few(3, 100)},
                   {.name = "standard", .rows = all(5, 200)},
                   {.name = "paper", .rows = all(5, 1000)}},
      .methods = {method("hig", -0.5),
                  method("gn", -1),
                  method("hig-f32", -0.5),
                  method("gn-f32", -1),
                  method("hig-tau7", -0.5, 1e-7),
                  method("hig-f32-tau7", -0.5, 1e-7)},
      .report = report,
  });
}

}  // namespace physinv::dipole
