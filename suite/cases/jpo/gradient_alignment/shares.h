/// What was measured of Fig. 2 of the JPO paper, and the theory of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "suite/cases/jpo/gradient_alignment/theory.h"
#include "suite/evidence/runs.h"

namespace physinv::alignment {

inline constexpr const char* kName = "jpo/gradient-alignment";
inline constexpr double kWeak = 0.1, kEven = 1;  ///< signal-to-noise ratios
/// Repetitions a claim needs.
inline constexpr Index kJudged = 300, kFull = 1000;

/// Shares measured for one method and kind of gradient, by n.
struct Aligned {
  std::vector<Index> n;
  std::vector<double> share, error;  ///< mean and its standard error
  Index repetitions = 0;             ///< the fewest of any n

  std::optional<std::size_t> find(Index size) const {
    const auto found = std::find(n.begin(), n.end(), size);
    if (found == n.end()) return {};
    return static_cast<std::size_t>(found - n.begin());
  }
  std::optional<double> at(Index size) const {
    const auto i = find(size);
    return i ? std::optional(share[*i]) : std::nullopt;
  }
  std::size_t count() const { return n.size(); }
};

/// Everything that Fig. 2 shows; what was not measured is empty.
struct Fig2 {
  std::optional<Aligned> known_sum, known_vote, unequal_sum, unequal_vote,
      linear, free, sum, vote;
  std::optional<ResponseFit> linear_fit, sine_fit;
  Response paper;  ///< of Fig. 2b

  explicit Fig2(const Evidence& evidence);
  /// All of what the method measures, at the same numbers of examples.
  bool has(std::string_view method) const;

  static double rho(Index n, const Response& response) {
    return response_curve(n, response).back();
  }
  /// p_N of panels (c) and (d).
  double combined(Index n, double q) const {
    return align_combined(q, rho(n, sine_fit->response));
  }
};

inline double sum_weak(Index n) { return align_sum(n, kWeak); }
inline double vote_weak(Index n) { return align_vote(n, kWeak); }
inline double vote_printed(Index n) { return align_vote_printed(n, kWeak); }
inline double sum_even(Index n) { return align_sum(n, kEven); }
inline double vote_even(Index n) { return align_vote(n, kEven); }

}  // namespace physinv::alignment
