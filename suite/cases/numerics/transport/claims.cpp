// What claims.md uses and formulas cannot express.
#include "suite/cases/common/claims.h"

#include <optional>

#include "suite/core/math.h"

namespace physinv::numerics::transport {
namespace {

/// The largest entry of an array, nothing where one was not finite.
RunValue largest(ArrayKey array) {
  return [=](const Run& run) -> std::optional<double> {
    const auto& all = run.stage->arrays.at(array);
    if (all.minCoeff() < 0) return {};
    return all.maxCoeff();
  };
}

/// log2 of the errors' ratio between the two finest grids.
RunValue observed_order(ArrayKey array) {
  return [=](const Run& run) -> std::optional<double> {
    const auto& e = run.stage->arrays.at(array);
    const Index last = e.cols() - 1;
    return math::log2(e(0, last - 1) / e(0, last));
  };
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.add("largest", largest);
  names.add("observed_order", observed_order);
  add_claims_of_folder(r, "numerics/transport", names);
}

}  // namespace physinv::numerics::transport
