/// Claims: conditions on measured numbers, as data of an experiment.
///
///   {.id = "P2", .where = "Fig. 3", .from = "standard",
///    .says = "HIG takes fewer updates than Adam",
///    .conditions = {within("updates to 0.1", median(...), 55, 95)}}
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "suite/evidence/cause.h"
#include "suite/evidence/condition.h"

namespace physinv {

struct Claim {
  std::string id;     ///< unique within the experiment; P... is the paper's
  std::string where;  ///< place in the paper; empty: a range of the suite
  std::string from;   ///< lowest profile that can decide it
  std::string says;   ///< without bounds: these write their own words
  /// All have to hold. None that decides: the numbers are reported.
  std::vector<Condition> conditions;
  std::string note = {};  ///< how it is read, what was run
  Cause cause = {};       ///< of a claim that is not reproduced
  bool gates = true;

  Origin origin() const {
    return where.empty() ? Origin::suite : Origin::paper;
  }
};

/// `profiles` are the experiment's in ascending order. A claim is judged from
/// the profile it names or a later one; below, and where runs are missing, it
/// is not judged, with what is missing. One condition that fails decides, even
/// if others are missing; what that counts as, its cause tells. If none fails
/// and some are missing, the claim is judged in part.
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

/// Its own and those of its cause: what registration checks.
std::vector<Condition> all_conditions(const Claim& claim);

/// What is wrong with a claim by itself, one line each: no id, a claim of the
/// paper without a place, no conditions, an unknown profile, a cause that is no
/// line or counts as holding.
std::vector<std::string> errors_of(const Claim& claim,
                                   const std::vector<std::string>& profiles);

/// Printed values that claims name and the paper's file lacks.
std::vector<std::string> unknown_printed(const std::vector<Claim>& claims,
                                         const std::string& experiment,
                                         const Published& published);

}  // namespace physinv
