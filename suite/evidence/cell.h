/// Cells of tables. What is not there says why, in the same words everywhere.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "suite/evidence/quantity.h"
#include "suite/results/report_model.h"

namespace physinv {

inline constexpr const char* kNotRun = "not run";
/// Its stages, of several threads, shared their cores: their times are no
/// times.
inline constexpr const char* kCrowded = "crowded";
inline constexpr const char* kDiverged = "diverged";
/// A question that does not arise.
inline constexpr const char* kNothing = "–";

/// The number with as many digits as the table shows; `otherwise` without one.
Cell cell_of(std::optional<double> value, const char* otherwise = kNotRun);
/// Mean and deviation of one number per seed.
Cell cell_of(std::span<const double> values, const char* otherwise = kNotRun);

/// Value and spread.
Cell cell_of(const Measured& measured);

/// The number as text: fmt's format, "not finite" for what is not.
Cell written(std::optional<double> value,
             const char* format = "{:.3g}",
             const char* otherwise = kNotRun);
Cell written(const Measured& measured, const char* format = "{:.3g}");

/// The cell with what the paper prints, if it does.
Cell beside_printed(Cell cell,
                    const Evidence& evidence,
                    const std::string& quantity);

/// Which stages a table of times is of. Its note says which clock they are from
/// and how many were crowded or changed their threads.
class TimedStages {
 public:
  /// Seconds of solving, if they are known (suite/results/crowded.h).
  std::optional<double> seconds(const StageRecord& stage);
  std::string note() const;

 private:
  int stages_ = 0, crowded_ = 0, changed_ = 0;
};

}  // namespace physinv
