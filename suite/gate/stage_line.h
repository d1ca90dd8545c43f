/// What a baseline holds of one stage, on one line:
///
///   jpo/billiards/jpo/n=4/seed=0/fit trajectory=9f.. results=04..
///   stop=iterations status=maxiter:4 loss=1.2e-02,2.6e-02,4.3e-02
///   x=-1.8072345 digits=5 iterations=50 vjp=200 network_forward=204
///   ms=9.6..9.9
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "suite/results/ends.h"
#include "suite/store/record.h"

namespace physinv {

/// What must not grow.
inline constexpr std::array<std::string_view, 7> kWork = {"iterations",
                                                          "forward",
                                                          "vjp",
                                                          "jacobian",
                                                          "inverse",
                                                          "network_forward",
                                                          "network_backward"};

/// Final losses of a stage's examples: the finite ones.
struct Losses {
  double best = 0, median = 0, worst = 0;
  Index nonfinite = 0;
};

struct StageLine {
  std::string name;        ///< case/stage
  std::string trajectory;  ///< hash of all iterates
  std::string results;     ///< hash of estimates, losses, curves, findings
  Stop stop = Stop::iterations;
  std::string message;  ///< why it failed; not part of the line
  StatusCounts statuses{};
  Losses losses;
  /// Projection of the estimates on a random vector: that of two runs differs
  /// by about the norm of their difference. Absent in lines of older versions.
  std::optional<double> x;
  double x_norm = 0;  ///< of the estimates; not part of the line
  int digits = 0;     ///< of the losses, that are stable; or kNoDigits
  std::array<std::uint64_t, kWork.size()> work{};
  /// How far they moved when the data were one ulp off.
  std::array<std::uint64_t, kWork.size()> jitter{};
  double fastest = 0, slowest = 0;  ///< milliseconds of solving, of the runs
};

/// Of a finished stage that ran once: `enter_disturbed` adds `digits` and
/// `jitter`.
StageLine line_of(const StageRecord& record);

/// Enters what the same stage did with data one ulp off. Numbers in that
/// `precision` were computed.
void enter_disturbed(StageLine& line,
                     const StageLine& disturbed,
                     Precision precision);

/// Digits after the point of its losses, as the line has them.
int shown_digits(const StageLine& line);

bool same_bits(const StageLine& a, const StageLine& b);

std::string case_of(std::string_view stage_name);

std::string to_text(const StageLine& line);
/// Throws std::runtime_error; also if a field is missing or repeated.
StageLine stage_line(std::string_view text);

}  // namespace physinv
