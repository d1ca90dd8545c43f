/// Campaigns side by side: commits, machines, precisions. Stages pair by
/// experiment, method, n, seed and stage; whatever else differs is what is
/// compared. The first side is the one that the others are held against.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

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

/// What one side says of one stage, or of a group of them.
struct Reading {
  std::size_t stages = 0;
  std::size_t same_bits = 0;            ///< as on the first side
  std::map<std::string, Index> ends;    ///< of the stages: converged, ...
  std::map<std::string, Index> states;  ///< of the examples: gtol, ...
  double loss = 0;     ///< median; infinite where it is not finite
  double seconds = 0;  ///< of solving
  Index iterations = 0;
  Counts counts;

  double simulations() const;
  double passes() const;  ///< of networks
};

/// Losses below this are solved: that they differ counts for nothing.
inline constexpr double kSolvedLoss = 1e-12;

/// b over a, both raised to kSolvedLoss.
double loss_ratio(const Reading& a, const Reading& b);

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

  bool missing() const;
  bool ends_changed() const;
  /// How much: decades of loss, work and time, whichever is most; a changed
  /// end counts before any of them, a missing side before that.
  double change() const;
};

enum class By { seed, n, method };

struct Comparison {
  std::vector<std::string> labels;
  std::vector<Compared> rows;  ///< what changed most first
};

/// By seed: every stage. By n: over seeds. By method: over n and seeds. A
/// group counts only the runs that all sides have.
Comparison compare(const std::vector<Side>& sides, By by);

/// A claim whose verdict is not the same on all sides.
struct ChangedClaim {
  std::string experiment;
  std::vector<std::optional<ClaimResult>> sides;
};
std::vector<ChangedClaim> changed_claims(const std::vector<Side>& sides);

/// The stages of all sides, sorted by the revision they ran from: a side for
/// each, in order of appearance.
std::vector<Side> sides_by_revision(const std::vector<Side>& sides);

/// All sides as one campaign, in which the same method of two sides is two
/// methods, "bfgs, LABEL".
Results pooled(const std::vector<Side>& sides);

}  // namespace physinv
