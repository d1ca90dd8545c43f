// HIG paper, Fig. 4b's floor: the quantum dipole's control optimised without a
// network, in double and in float.
#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "optimizers/half_inverse_direct.h"
#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/cases/hig/common/report.h"
#include "suite/cases/hig/quantum_dipole/direct_metrics.h"
#include "suite/cases/hig/quantum_dipole/runs.h"
#include "suite/cases/jpo/common/claims.h"
#include "suite/cases/jpo/common/endings.h"
#include "suite/evidence/curve.h"
#include "suite/harness/registry.h"

namespace physinv::dipole {
namespace {

constexpr const char* kName = "hig/quantum-dipole-direct";
Method method(std::string id, double kappa) {
  return {.id = std::move(id),
          .chain = {half_inverse_direct({.power = {.kappa = kappa, .tau = 1e-5},
                                         .rate = 0.5,
                                         .metrics = losses_in_float()})}};
}

// ---- claim ------------------------------------------------------------------

/// A number of update 100.
Value after_100(const std::function<double(const StageRecord&, Index)>& value) {
  return [=](const StageRecord& s) -> std::optional<double> {
    for (Index k = 0; k < s.curve.points(); ++k)
      if (CurveRow{s}.updates(k) >= 100) return value(s, k);
    return {};
  };
}

Value in_float(Formula row) {
  return after_100([=](const StageRecord& s, Index k) {
    return CurveRow{s, "metrics", row}(k);
  });
}

ClaimResult no_floor(const Results& results) {
  const Value named = after_100([](const StageRecord& s, Index k) {
    return s.curve.loss.col(k).head(kNamed).maxCoeff();
  });
  const Value middle = after_100([](const StageRecord& s, Index k) {
    const Vector<double> all = s.curve.loss.col(k);
    return median({all.begin(), all.end()});
  });
  const Value worst = after_100([](const StageRecord& s, Index k) {
    return s.curve.loss.col(k).maxCoeff();
  });
  const auto of = [&](const char* method, const Value& value) {
    return Seeds(results, method, value, kName).highest();
  };
  Judge judge;
  judge.below("float64", of("hig", named), 1e-7)
      .below(
          "float32, |psi - <t, psi> t|^2", of("hig-f32", in_float(kRest)), 1e-7)
      .report("float32, 1 - |<t, psi>|^2", of("hig-f32", in_float(kOverlap)))
      .report("GN float64", of("gn", named))
      .report("GN float32", of("gn-f32", in_float(kRest)))
      .report("random targets, float64, median", of("hig", middle))
      .report("worst", of("hig", worst));
  return std::move(judge).result(
      "A9",
      "A control optimised without a network (target angles 0.7 and 2) goes "
      "below 1e-7 in 100 updates, in double and, by the formula that does not "
      "cancel, in float",
      "quick");
}

// ---- report -----------------------------------------------------------------

const std::vector<MethodLine> kLines = {
    {"hig", "HIG", "jpo"},
    {"gn", "Gauss-Newton", "bfgs"},
    {"hig-f32", "HIG, float", "gd"},
    {"gn-f32", "Gauss-Newton, float", "supervised"}};

Section report(const Results& results, const Published&) {
  Section section{.experiment = kName,
                  .title = "Quantum dipole, control without a network",
                  .paper = "hig",
                  .tables = {loss_table(results, kName, kLines)},
                  .claims = {no_floor(results)}};
  LearningCurves curves(results, section);
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

std::vector<Row> rows(std::vector<std::uint64_t> seeds, Index updates) {
  return {{.methods = {"hig", "gn"},
           .n = {16},
           .seeds = seeds,
           .iterations = updates,
           .precision = Precision::f64},
          {.methods = {"hig-f32", "gn-f32"},
           .n = {16},
           .seeds = seeds,
           .iterations = updates,
           .precision = Precision::f32}};
}

const auto kRegistered = register_experiment({
    .name = kName,
    .title = "Quantum dipole, control without a network",
    .source = {.paper = "hig", .where = "Sec. 3.3, Fig. 4b"},
    .problem = problem<QuantumDipole>("quantum_dipole", {.angles = {0.7, 2}}),
    .setting = {.recorded = 16},
    .profiles = {{.name = "smoke", .rows = rows({0}, 20)},
                 {.name = "quick", .rows = rows({0, 1, 2}, 100)},
                 {.name = "standard", .rows = rows({0, 1, 2, 3, 4}, 200)},
                 {.name = "paper", .rows = rows({0, 1, 2, 3, 4}, 1000)}},
    .methods = {method("hig", -0.5),
                method("gn", -1),
                method("hig-f32", -0.5),
                method("gn-f32", -1)},
    .report = report,
});

}  // namespace
}  // namespace physinv::dipole
