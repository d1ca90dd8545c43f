/// A campaign compared with a baseline, stage by stage.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "suite/gate/stage_line.h"

namespace physinv {

enum class Change {
  same,     ///< the same bits, no more work
  within,   ///< other bits, none promised; losses within the stored digits
  better,   ///< smaller losses, a better end or less work
  worse,    ///< a worse end, larger losses, more work, or bits that were
            ///< promised and are others
  missing,  ///< the baseline has it, the campaign has not
  added     ///< the campaign has it, the baseline has not
};
std::string_view to_string(Change change);

struct Rules {
  bool bits = true;         ///< promised: baseline and campaign of one build
  bool allow_work = false;  ///< counters may grow
};

/// What speaks against a stage and for it, and what else is not as it was.
struct Reasons {
  std::vector<std::string> worse, better, other;
  /// "a; b", or "worse: a; better: b" where there are several kinds.
  std::string text() const;
};

/// How far a stage of other bits is from the baseline's, as relative changes of
/// the numbers of its line; 0 where that is the same to the digits held.
struct Distance {
  std::optional<double> x;  ///< of the estimates by their norm, or none
  double loss = 0;          ///< the largest of the three
  std::string_view which;   ///< "best", "median", "worst"
};

struct StageVerdict {
  std::string stage;
  Change change = Change::same;
  Reasons reasons;
  std::optional<Distance> distance;  ///< if the bits are others
  StageLine before, now;
};

/// Names agree.
StageVerdict judge(const StageLine& before, const StageLine& now, Rules rules);

/// All stages of both, in the order of the baseline, added ones last.
std::vector<StageVerdict> judge(const std::vector<StageLine>& before,
                                const std::vector<StageLine>& now,
                                Rules rules);

/// Worse or missing.
inline bool fails(const StageVerdict& j) {
  return j.change == Change::worse || j.change == Change::missing;
}

}  // namespace physinv
