#include "suite/evidence/statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "suite/core/math.h"

namespace physinv {

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  const double at = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double share = at - static_cast<double>(below);
  if (share == 0 || values[below] == values[below + 1]) return values[below];
  return (1 - share) * values[below] + share * values[below + 1];
}

double mean_of(std::vector<double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) /
         static_cast<double>(values.size());
}
double least_of(std::vector<double> values) {
  return *std::min_element(values.begin(), values.end());
}
double most_of(std::vector<double> values) {
  return *std::max_element(values.begin(), values.end());
}

std::optional<MeanStd> mean_std(std::span<const double> values) {
  if (values.empty()) return {};
  const auto count = static_cast<double>(values.size());
  double sum = 0, squares = 0;
  for (const double v : values) sum += v;
  MeanStd out{sum / count, {}};
  for (const double v : values) squares += (v - out.mean) * (v - out.mean);
  if (values.size() > 1) out.std = std::sqrt(squares / (count - 1));
  return out;
}

std::optional<Line> fit_line(std::span<const double> x,
                             std::span<const double> y) {
  if (x.size() < 3 || x.size() != y.size()) return {};
  const auto count = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0, residuals = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    mean_x += x[i] / count, mean_y += y[i] / count;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  Line line{.slope = xy / xx};
  line.intercept = mean_y - line.slope * mean_x;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double residual = y[i] - line.intercept - line.slope * x[i];
    residuals += residual * residual;
  }
  line.slope_error = std::sqrt(residuals / (count - 2) / xx);
  return line;
}

double chi_squared_tail(double x, int degrees) {
  // Two degrees less have the tail without its last term.
  const double half = 0.5 * x;
  if (!(half > 0)) return 1;
  const bool odd = degrees % 2 == 1;
  double tail = odd ? math::erfc(std::sqrt(half)) : 0;
  double a = odd ? 0.5 : 0;
  double term = odd ? math::exp(-half) / std::sqrt(std::numbers::pi * half)
                    : math::exp(-half);
  // term = half^a exp(-half) / Gamma(a + 1), from a = -1/2 or 0.
  if (odd) term *= half / 0.5;
  for (; 2 * a < degrees; term *= half / ++a) tail += term;
  return tail;
}

}  // namespace physinv
