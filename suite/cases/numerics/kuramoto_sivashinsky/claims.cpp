// What claims.md uses and formulas cannot express.
#include "suite/cases/common/claims.h"

#include <optional>

#include "suite/cases/numerics/kuramoto_sivashinsky/sweep.h"
#include "suite/core/math.h"

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
RunValue typical_at(ArrayKey array, double end) {
  return [=](const Run& run) -> std::optional<double> {
    const auto& time = run.stage->arrays.at("time");
    for (Index k = 0; k < time.cols(); ++k)
      if (time(0, k) == end) return typical(*run.stage, array, k);
    return {};
  };
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.add("typical", typical_at);
  r.add_claims(kName, order_claims(parameters()));
  add_claims_of_folder(r, "numerics/kuramoto_sivashinsky", names);
  r.add_claims(kName, {adjoint_claim("N3", {"parameters", "horizons"})});
}

}  // namespace physinv::ks_numerics
