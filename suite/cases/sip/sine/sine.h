/// The points of the sine's sweeps (SIP paper, App. B.1, Fig. 5): stretches at
/// no turn, turns at stretch 32. The studies of its settings: gamma and rates.
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

inline SinePlaneOptions options_of(const Point& p) {
  return {.xi = double(p.xi), .degrees = double(p.degrees)};
}

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

/// Stretches, without a turn, of the studies.
inline const std::vector<int> kStudied = {1, 32};

/// Adam at these.
inline const std::vector<int> kGammas = {1, 3, 10, 30, 100};
inline std::string gamma_study(int xi, int gamma) {
  return fmt::format("sip/sine-xi{}-gamma{}", xi, gamma);
}

/// The paper's methods.
struct MethodName {
  const char *id, *label;
};
inline const std::vector<MethodName> kSix = {{"sip", "SIP"},
                                             {"adam", "Adam"},
                                             {"sgd", "SGD"},
                                             {"adadelta", "Adadelta"},
                                             {"adagrad", "Adagrad"},
                                             {"rmsprop", "RMSprop"}};
/// Each at its rate times these.
struct RateFactor {
  const char* name;
  double value;
  const char* label;
};
inline const std::vector<RateFactor> kFactors = {{"x0p1", 0.1, "a tenth"},
                                                 {"x0p3", 1.0 / 3, "a third"},
                                                 {"x1", 1, "the rate"},
                                                 {"x3", 3, "3 times"},
                                                 {"x10", 10, "10 times"}};
inline std::string rate_study(int xi) {
  return fmt::format("sip/sine-xi{}-rates", xi);
}
/// "adam-rate-x3"
inline std::string at_rate(const std::string& method, const char* factor) {
  return method + "-rate-" + factor;
}

}  // namespace physinv::sine
