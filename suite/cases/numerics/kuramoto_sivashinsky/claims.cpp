// The Kuramoto-Sivashinsky solver: order of its steps, growth of
// perturbations, derivatives.
#include <cmath>
#include <optional>
#include <vector>

#include "suite/cases/numerics/kuramoto_sivashinsky/sweep.h"
#include "suite/core/math.h"
#include "suite/harness/registry.h"

namespace physinv::ks_numerics {

std::optional<double> typical(const StageRecord& s,
                              ArrayKey array,
                              Index horizon) {
  const auto values = s.arrays.at(array).col(horizon);
  double sum = 0;
  Index count = 0;
  for (const double v : values)
    if (v > 0) sum += math::log(v), ++count;
  if (count == 0) return {};
  return math::exp(sum / static_cast<double>(count));
}

namespace {

/// A typical number of the growth stage at an end time.
Quantity at(ArrayKey array, double end) {
  return median({"growth"}, [=](const Run& run) -> std::optional<double> {
    const auto& time = run.stage->arrays.at("time");
    for (Index k = 0; k < time.cols(); ++k)
      if (time(0, k) == end) return typical(*run.stage, array, k);
    return {};
  });
}

std::vector<Claim> claims() {
  std::vector<Claim> all = order_claims(parameters());
  all.push_back(
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
                            1e-2)}});
  all.push_back(adjoint_claim("N3", {"parameters", "horizons"}));
  return all;
}

}  // namespace

void add_claims(Registry& r) { r.add_claims(kName, claims()); }

}  // namespace physinv::ks_numerics
