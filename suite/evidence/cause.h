/// Why a claim does not come out as printed: one line, in the claim itself.
///
///   .cause = depends("labels are as many as problems; their number is not "
///                    "printed")
///   .cause = contradiction("Table 3 falls with n, App. D says it grows",
///                          {below("printed, n = 128 less n = 4", ..., 0)})
///
/// The verdict is computed all the same: a cause tells what a failed condition
/// counts as, and is stale once the claim holds.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "suite/evidence/condition.h"

namespace physinv {

struct Cause {
  /// What a claim that fails comes to; of a claim that is not judged or only
  /// reported, that.
  Verdict as = Verdict::not_reproduced;
  std::string why = {};
  /// What has to hold for it, so far as it was run: the same direction, the
  /// printed numbers that disagree. If it does not, the claim fails
  /// unexplained.
  std::vector<Condition> shown_by = {};
};

/// Stronger or weaker than printed, the same direction, which `shown_by` tells;
/// `why` has both numbers.
inline Cause differs(std::string why, std::vector<Condition> shown_by) {
  return {Verdict::differs, std::move(why), std::move(shown_by)};
}
/// Reproduced for some settings of a choice that the paper does not print, and
/// not for others; `why` names both.
inline Cause depends(std::string why, std::vector<Condition> shown_by = {}) {
  return {Verdict::depends, std::move(why), std::move(shown_by)};
}
/// The paper's own tables, formulas or sentences disagree; `why` has both
/// places.
inline Cause contradiction(std::string why,
                           std::vector<Condition> shown_by = {}) {
  return {Verdict::contradiction, std::move(why), std::move(shown_by)};
}
/// It fails, and nothing explains that away.
inline Cause fails(std::string why) {
  return {Verdict::not_reproduced, std::move(why)};
}
/// Not judged, in part or at all: what a run would take.
inline Cause not_run(std::string why) {
  return {Verdict::not_judged, std::move(why)};
}
/// Its numbers are reported and decide nothing.
inline Cause reported(std::string why) {
  return {Verdict::reported, std::move(why)};
}

}  // namespace physinv
