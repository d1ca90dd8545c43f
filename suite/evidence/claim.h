/// Claims: conditions on measured numbers, as data of an experiment.
///
///   {.id = "P2", .where = "Fig. 3", .from = "standard",
///    .says = "HIG takes fewer updates than Adam",
///    .conditions = {within("updates to 0.1", median(...), 55, 95)}}
///
/// Why one does not come out as printed, its cause says in one line:
///
///   .cause = depends("labels are as many as problems; their number is not "
///                    "printed")
///   .cause = contradiction("Table 3 falls with n, App. D says it grows",
///                          {below("printed, n = 128 less n = 4", ..., 0)})
///
/// The verdict is still computed: a cause says what a failed condition counts
/// as, and is stale once the claim holds.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "suite/evidence/cause_numbers.h"
#include "suite/evidence/condition.h"

namespace physinv {

struct Cause {
  /// The verdict if the claim fails; also that of a claim that is not judged or
  /// only reported.
  Verdict as = Verdict::not_reproduced;
  std::string why = {};  ///< numbers in braces as they are written
  /// What has to hold for it, so far as it was run: the same direction, the
  /// printed numbers that disagree. If it does not, the claim fails
  /// unexplained.
  std::vector<Condition> shown_by = {};
  std::vector<CauseNumber> numbers = {};  ///< in the braces of `why`
};

/// Stronger or weaker than printed, in the same direction, which `shown_by`
/// checks; `why` has both numbers.
inline Cause stronger(std::string why, std::vector<Condition> shown_by) {
  return {Verdict::stronger, std::move(why), std::move(shown_by)};
}
inline Cause weaker(std::string why, std::vector<Condition> shown_by) {
  return {Verdict::weaker, std::move(why), std::move(shown_by)};
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

struct Claim {
  std::string id;     ///< unique within the experiment; P... is the paper's
  std::string where;  ///< place in the paper; empty: a range of the suite
  /// Lowest profile that can decide it; where none is named, `paper` of what
  /// the paper claims, `quick` of the suite's ranges.
  std::string from = {};
  std::string says;  ///< without bounds: these write their own words
  /// All have to hold. None that decides: the numbers are reported.
  std::vector<Condition> conditions;
  std::string note = {};  ///< how it is read, what was run
  Cause cause = {};       ///< of a claim that is not reproduced
  bool gates = true;

  Origin origin() const {
    return where.empty() ? Origin::suite : Origin::paper;
  }
  std::string judged_from() const {
    if (!from.empty()) return from;
    return origin() == Origin::paper ? "paper" : "quick";
  }
};

/// `profiles` are the experiment's in ascending order. A claim is judged from
/// the profile it names or a later one; below, and where runs are missing, it
/// is not judged, with what is missing. One condition that fails decides, even
/// if others are missing; its cause says what that counts as. If none fails and
/// some are missing, the claim is judged in part.
std::vector<ClaimResult> judge(const std::vector<Claim>& claims,
                               const Evidence& evidence,
                               const std::vector<std::string>& profiles);

/// Judged again from the numbers that an earlier judgement kept, as far as the
/// claim still asks for them: a condition of another label or relation is
/// missing, "not kept".
ClaimResult judge_again(const Claim& claim,
                        const ClaimResult& kept,
                        const Remains& remains);

/// The cases that the decided conditions of a claim select, so many times as
/// they do.
std::int64_t cases_behind(const Claim& claim,
                          const ClaimResult& judged,
                          const Evidence& evidence);

/// "Adam / HIG > 2; updates to 0.1 in 55 .. 95"
std::string conditions_text(const Claim& claim);

/// Its own, those of its cause and the numbers in its text: what registration
/// checks.
std::vector<Condition> all_conditions(const Claim& claim);

/// What is wrong with a claim by itself, one line each: no id, a claim of the
/// paper without a place, no conditions, an unknown profile, a cause that is
/// not a line or counts as holding.
std::vector<std::string> errors_of(const Claim& claim,
                                   const std::vector<std::string>& profiles);

/// Printed values that claims name and the paper's file lacks.
std::vector<std::string> unknown_printed(const std::vector<Claim>& claims,
                                         const std::string& experiment,
                                         const Published& published);

}  // namespace physinv
