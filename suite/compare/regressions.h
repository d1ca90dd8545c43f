/// What got worse from the first side to another, pair by pair.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "suite/compare/comparison.h"

namespace physinv {

/// loss: larger by the factor, or no longer finite. status: a worse end.
/// claims: a worse verdict. work: more simulations or passes of networks. time:
/// longer by the factor. missing: a side lacks a stage.
enum class Aspect { loss, status, claims, work, time, missing };
inline constexpr std::string_view kAspects =
    "loss, status, claims, work, time, missing";
std::optional<Aspect> aspect_of(std::string_view word);

struct Regression {
  std::size_t worse = 0, judged = 0;  ///< pairs; of claims claims
  std::string worst;                  ///< "jpo/... solve: converged -> failed"
  /// Nothing but time, or no known time to compare with. A stage that ends
  /// worse has no cost to judge, and it is not this.
  bool of_time = false;
  std::string text() const;
};

/// Empty if nothing of this got worse. Costs are judged of pairs whose costs
/// compare (reading.h) and of those that the end of a worse stage takes away.
std::optional<Regression> regression(Aspect aspect,
                                     const Comparison& comparison,
                                     const std::vector<ChangedClaim>& claims,
                                     double factor);

/// How pairs ended, and how many have times that compare: one line, for readers
/// of "nothing got worse".
std::string pairs_text(const Comparison& comparison);

}  // namespace physinv
