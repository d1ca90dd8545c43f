/// What the curves of a panel are made of.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include "reports/svg.h"
#include "suite/results/report_model.h"

namespace physinv {

inline std::size_t points(const Series& s) {
  return std::min(s.x.size(), s.y.size());
}

inline bool has_spread(const Series& s) {
  return !s.y.empty() && s.lo.size() == s.y.size() && s.hi.size() == s.y.size();
}

/// Points that are not joined, and few marks, have bars instead of a band.
inline bool has_error_bars(const Series& s) {
  constexpr std::size_t kFewPoints = 12;
  return has_spread(s) && (!s.line || (s.markers && s.y.size() <= kFewPoints));
}

/// A step of a path: M moves there, L draws a line.
inline std::string path_step(char verb, double x, double y) {
  return verb + svg_number(x) + ' ' + svg_number(y);
}

}  // namespace physinv
