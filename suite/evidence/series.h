/// Numbers of axes, and series of figures that are no curves.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

/// So many numbers from `first` to `last`, equally far apart.
inline std::vector<double> spaced(double first, double last, int count) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k)
    values.push_back(first + (last - first) * k / (count - 1));
  return values;
}

/// One point, marked.
inline Series mark(std::string label,
                   std::string method,
                   double x,
                   double y,
                   std::optional<PlotStyle> style = {}) {
  return {.label = std::move(label),
          .method = std::move(method),
          .x = {x},
          .y = {y},
          .line = false,
          .markers = true,
          .style = style};
}

/// A dashed line at one height.
inline Series level(std::string label,
                    std::string method,
                    double from,
                    double to,
                    double y,
                    std::optional<PlotStyle> style = {}) {
  return {.label = std::move(label),
          .method = std::move(method),
          .x = {from, to},
          .y = {y, y},
          .dashed = true,
          .style = style};
}

}  // namespace physinv
