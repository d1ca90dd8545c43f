// The Kuramoto-Sivashinsky solver: order of its steps, growth of
// perturbations, derivatives.
#include <cmath>
#include <optional>
#include <vector>

#include "suite/cases/numerics/kuramoto_sivashinsky/sweep.h"
#include "suite/harness/registry.h"

namespace physinv::ks_numerics {

std::optional<double> step_error(const CaseRecord& chain, Index steps) {
  for (const StageRecord& s : chain.stages) {
    if (s.stage != stage_name(steps) || !s.arrays.contains("error")) continue;
    const auto& error = s.arrays.at("error");
    if (error.minCoeff() >= 0) return error.mean();
  }
  return {};
}

std::optional<double> typical(const StageRecord& s,
                              const char* array,
                              Index horizon) {
  const auto values = s.arrays.at(array).col(horizon);
  double sum = 0;
  Index count = 0;
  for (const double v : values)
    if (v > 0) sum += std::log(v), ++count;
  if (count == 0) return {};
  return std::exp(sum / static_cast<double>(count));
}

namespace {

/// Log2 of the error with steps twice as long over that with these, in double.
RunValue order_of(Index steps) {
  return [=](const Run& run) -> std::optional<double> {
    if (run.record->info.precision != Precision::f64) return {};
    const auto fine = step_error(*run.record, steps),
               coarse = step_error(*run.record, steps / 2);
    if (!fine || !coarse || *fine == 0 || *coarse == 0) return {};
    return std::log2(*coarse / *fine);
  };
}

/// Longer steps than 1/16 are not yet in the regime of small steps.
std::vector<Quantity> orders() {
  std::vector<Quantity> all;
  for (const Index steps : {400, 800, 1600})
    all.push_back(
        median({"work-precision", stage_name(steps)}, order_of(steps)));
  return all;
}

/// A typical number of the growth stage at an end time.
Quantity at(const char* array, double end) {
  return median({"growth"}, [=](const Run& run) -> std::optional<double> {
    const auto& time = run.stage->arrays.at("time");
    for (Index k = 0; k < time.cols(); ++k)
      if (time(0, k) == end) return typical(*run.stage, array, k);
    return {};
  });
}

const bool kClaims = register_claims(
    kName,
    {{.id = "N1",
      .from = "smoke",
      .says = "The time integration is of second order for steps below 1/8",
      .conditions = {at_least("lowest order", least(orders()), 1.8),
                     at_most("highest order", most(orders()), 2.2)}},
     {.id = "N2",
      .from = "smoke",
      .says = "Perturbations grow with time, and yet float is good for the "
              "experiment, whose end is t = 25",
      .conditions = {above("growth until t = 25", at("perturbation", kEnd), 3),
                     above("growth until t = 100",
                           at("perturbation", 100),
                           at("perturbation", kEnd)),
                     below("float error of u(25)", at("rounding", kEnd), 1e-3),
                     below("float error of the gradient",
                           at("gradient_error", kEnd),
                           1e-2)}},
     adjoint_claim("N3", {"parameters", "horizons"})});

}  // namespace
}  // namespace physinv::ks_numerics
