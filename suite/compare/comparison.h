/// Campaigns side by side: commits, machines, precisions. Stages pair by
/// experiment, method, n, seed and stage; whatever else differs is what is
/// compared. The others are compared with the first side.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "suite/compare/reading.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv {

struct JudgedClaim {
  std::string experiment;
  ClaimResult claim;
};

/// One campaign.
struct Side {
  std::string label;
  Results results;
  std::vector<JudgedClaim> claims;  ///< paper and suite, judged on it
};

struct StageId {
  std::string experiment, method;
  Index n = -1;            ///< -1: several
  std::int64_t seed = -1;  ///< -1: several
  std::string stage;
  auto operator<=>(const StageId&) const = default;
  std::string text() const;
};

/// One line of a comparison: a reading per side, absent where it has none.
struct Compared {
  StageId id;
  std::vector<std::optional<Reading>> sides;
  std::vector<Compared> members;  ///< of a group: its stages

  /// Those of a group; else this one alone. What is judged is judged of them:
  /// in a median, one that is lost would not be seen.
  std::span<const Compared> stages() const;
  bool missing() const;
  bool ends_changed() const;
  /// Ends and shares solved are equal, losses and work differ by less than
  /// 1 %, times by less than the factor; in a group those of every stage.
  bool unchanged(const Thresholds& thresholds) const;
  bool unchanged_on(std::size_t side, const Thresholds& thresholds) const;
  /// How much: decades of loss, work and time, whichever is most; a changed
  /// end counts before any of them. That of a group is the most of its stages.
  double change() const;
};

/// A side compared with the first, over the pairs of a line: the stages that
/// both have.
struct Against {
  std::size_t pairs = 0;
  std::size_t wins = 0;   ///< pairs with a lower loss
  std::size_t ties = 0;   ///< pairs with the same
  std::size_t worse = 0;  ///< pairs with a worse end
  std::size_t timed = 0;  ///< pairs that have a ratio of times
  /// Ratios over the pairs, absent if there are none.
  std::optional<Quartiles> loss, time, simulations, passes;
  std::optional<Quartiles> raised_time;  ///< both times raised to kShortTime
  std::string no_time;                   ///< why there is none
  /// One that the side lacks, else of the worst end, else of the largest ratio
  /// of losses, else of times. Null if the line has no stage on the first side.
  const Compared* worst = nullptr;
};
Against against(const Compared& line, std::size_t side);

enum class By { seed, n, method };

struct Comparison {
  std::vector<std::string> labels;
  /// What all sides have, what changed most first; then what one lacks.
  std::vector<Compared> rows;
  Thresholds thresholds = {};
};
/// What all sides have.
Comparison common(const Comparison& all);
/// Without the rows that are unchanged.
Comparison changed(const Comparison& all);

/// By seed: every stage. By n: over seeds. By method: over n and seeds. A
/// group's readings are of the runs that all sides have.
Comparison compare(const std::vector<Side>& sides,
                   By by,
                   const Thresholds& thresholds = {});

/// A claim whose verdict is not the same on all sides; where a side lacks it,
/// it is not judged.
struct ChangedClaim {
  std::string experiment;
  std::vector<std::optional<ClaimResult>> sides;

  std::string id() const;
  Verdict verdict(std::size_t side) const;
};
std::vector<ChangedClaim> changed_claims(const std::vector<Side>& sides);
/// Without those that a side does not judge, which says of nothing that it
/// changed.
std::vector<ChangedClaim> judged_everywhere(
    const std::vector<ChangedClaim>& changed);

/// The stages of all sides, sorted by the revision they ran from: a side for
/// each, in order of appearance.
std::vector<Side> sides_by_revision(const std::vector<Side>& sides);

/// All sides as one campaign, in which the same method of two sides is two
/// methods, "bfgs, LABEL".
Results pooled(const std::vector<Side>& sides);

}  // namespace physinv
