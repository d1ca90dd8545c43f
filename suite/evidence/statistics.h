/// Statistics over seeds, sizes and examples.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "suite/core/median.h"

namespace physinv {

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// The value with a share q of the others below it, linear between two.
/// Of a list that is not empty.
double quantile(std::vector<double> values, double q);

/// Of lists that are not empty.
double mean_of(std::vector<double> values);
double least_of(std::vector<double> values);
double most_of(std::vector<double> values);

/// Mean and ordinary sample standard deviation (divided by count - 1; empty
/// for a single value). Empty for no values.
struct MeanStd {
  double mean = 0;
  std::optional<double> std;
};
std::optional<MeanStd> mean_std(std::span<const double> values);

/// Least squares y = intercept + slope x, with the slope's standard error from
/// the residuals. Empty for fewer than three points.
struct Line {
  double intercept = 0, slope = 0, slope_error = 0;
};
std::optional<Line> fit_line(std::span<const double> x,
                             std::span<const double> y);

/// P(chi squared of so many degrees of freedom >= x).
double chi_squared_tail(double x, int degrees);

}  // namespace physinv
