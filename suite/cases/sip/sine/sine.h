/// The points of the sine's sweeps (SIP paper, App. B.1, Fig. 5): stretches at
/// no turn, turns at stretch 32, and what a training records of them.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "problems/sine_plane/sine_plane.h"

namespace physinv::sine {

struct Point {
  int xi, degrees;
  std::string experiment() const {
    return fmt::format("sip/sine-xi{}-phi{}", xi, degrees);
  }
};

inline const std::vector<int> kStretches = {1, 3, 5, 10, 20, 32, 48, 64};
inline const std::vector<int> kTurns = {0, 1, 3, 5, 10, 23, 35, 40, 45};
inline constexpr int kStretch = 32;  ///< of the sweep over turns
/// The point that every profile runs, and the one that is easy.
inline const Point kHard{32, 45}, kEasy{1, 45};

inline std::vector<Point> points() {
  std::vector<Point> all = {kHard, kEasy};
  for (const int xi : kStretches) all.push_back({xi, 0});
  for (const int degrees : kTurns)
    if (degrees != 0 && degrees != kHard.degrees)
      all.push_back({kStretch, degrees});
  return all;
}

}  // namespace physinv::sine
