// Half-inverse updates where their matrices are worst: what must hold in every
// combination.
#include <algorithm>
#include <functional>

#include "suite/cases/numerics/half_inverse/sweep.h"
#include "suite/harness/registry.h"

namespace physinv::half_inverse_numerics {
namespace {

/// Norms are rounded like the updates.
constexpr double kRounding = 1e-3;

/// A number of the sweep's cells.
Quantity of(std::function<double(const Cells&)> value) {
  return highest({kMethod, kStage}, [value](const Run& run) {
    return std::optional(value(Cells(*run.stage)));
  });
}

/// How many cells are so.
Quantity cells(bool (*chosen)(const Cells&, Index)) {
  return of([chosen](const Cells& c) {
    double n = 0;
    for (Index j = 0; j < c.count(); ++j) n += chosen(c, j);
    return n;
  });
}

/// Of an update over its bound, by the values kept (0) or by the cut (1).
Quantity largest_size(Index bound) {
  return of([bound](const Cells& c) {
    double largest = 0;
    for (Index j = 0; j < c.count(); ++j)
      largest = std::max(largest, c.get("size", j, bound));
    return largest;
  });
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

const std::vector<Claim> kClaims(
    {{.id = "N1",
      .from = "smoke",
      .says = "With a cut, no update and no loss is NaN or infinite",
      .conditions = {reported("cells", cells(any)),
                     at_most("not finite with a cut", cells(lost_with_cut), 0),
                     reported("refused or overflowing without one",
                              cells(lost_without_cut)),
                     reported("unproven", cells(unproven))}},
     {.id = "N2",
      .from = "smoke",
      .says = "Every update is as short as the singular values kept and the "
              "cut promise",
      .conditions = {at_most("largest over s_kept^kappa |g|",
                             largest_size(0),
                             1 + kRounding),
                     at_most("over (tau s_max)^kappa |g|",
                             largest_size(1),
                             1 + kRounding)}},
     {.id = "N3",
      .from = "smoke",
      .says = "Where updates are proven, a batch with every sample twice keeps "
              "no more singular values than with each once",
      .conditions = {reported("pairs", cells(twice)),
                     at_most("of the proven with more kept",
                             cells([](const Cells& c, Index j) {
                               return keeps_more(c, j) && proven(c, j);
                             }),
                             0),
                     reported("of the others",
                              cells([](const Cells& c, Index j) {
                                return keeps_more(c, j) && !proven(c, j);
                              }))}},
     {.id = "N4",
      .from = "smoke",
      .says = "A Jacobian of zeros gives updates that are exactly zero",
      .conditions = {
          at_least("cells with J = 0", cells(blind), 1),
          at_most("of them with an update", cells(blind_and_moved), 0)}}});

}  // namespace

void add_claims(Registry& r) { r.add_claims(kName, kClaims); }

}  // namespace physinv::half_inverse_numerics
