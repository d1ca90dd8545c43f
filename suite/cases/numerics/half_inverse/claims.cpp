// What claims.md uses and formulas cannot express.
#include "suite/cases/common/claims.h"

#include <algorithm>
#include <optional>

#include "suite/cases/numerics/half_inverse/sweep.h"

namespace physinv::half_inverse_numerics {
namespace {

/// How many cells are so.
RunValue cells(bool (*chosen)(const Cells&, Index)) {
  return [chosen](const Run& run) -> std::optional<double> {
    const Cells c(*run.stage);
    double n = 0;
    for (Index j = 0; j < c.count(); ++j) n += chosen(c, j);
    return n;
  };
}

/// Of an update over its bound, by the values kept (0) or by the cut (1).
RunValue largest_size(Index bound) {
  return [bound](const Run& run) -> std::optional<double> {
    const Cells c(*run.stage);
    double largest = 0;
    for (Index j = 0; j < c.count(); ++j)
      largest = std::max(largest, c.get("size", j, bound));
    return largest;
  };
}

bool any(const Cells&, Index) { return true; }
bool unproven(const Cells& c, Index j) {
  return c.is(StressStatus::unproven, j);
}
bool lost_with_cut(const Cells& c, Index j) {
  return c.tau(j) > 0 && c.is(StressStatus::nonfinite, j);
}
bool lost_without_cut(const Cells& c, Index j) {
  return c.tau(j) == 0 && c.is(StressStatus::nonfinite, j);
}
bool blind(const Cells& c, Index j) { return c.blind(j); }
bool blind_and_moved(const Cells& c, Index j) {
  return c.blind(j) && (c.get("norm", j) != 0 || !c.is(StressStatus::zero, j));
}
bool twice(const Cells& c, Index j) { return c.on(StressAxis::copies, j) != 0; }
bool keeps_more(const Cells& c, Index j) {
  return twice(c, j) && c.get("kept", j) > c.get("kept", c.once(j));
}
bool proven(const Cells& c, Index j) {
  return c.status(j) < StressStatus::unproven &&
         c.status(c.once(j)) < StressStatus::unproven;
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("cells", cells(any));
  names.set("unproven", cells(unproven));
  names.set("lost_with_cut", cells(lost_with_cut));
  names.set("lost_without_cut", cells(lost_without_cut));
  names.set("size_over_kept", largest_size(0));
  names.set("size_over_cut", largest_size(1));
  names.set("pairs", cells(twice));
  names.set("proven_with_more_kept", cells([](const Cells& c, Index j) {
              return keeps_more(c, j) && proven(c, j);
            }));
  names.set("others_with_more_kept", cells([](const Cells& c, Index j) {
              return keeps_more(c, j) && !proven(c, j);
            }));
  names.set("zero_jacobians", cells(blind));
  names.set("zero_jacobians_moved", cells(blind_and_moved));
  add_claims_of_folder(r, "numerics/half_inverse", names);
}

}  // namespace physinv::half_inverse_numerics
