/// The settings of BFGS and refinement that the study has.
#pragma once

#include <array>
#include <string>

namespace physinv::billiards_precision {

inline constexpr const char* kName = "studies/billiards-precision";
inline constexpr const char* kVaried = "jpo/billiards";

struct Setting {
  const char* id;     ///< of the methods bfgs-ID and jpo-ID
  const char* title;  ///< precision, gtol
  double gtol;
  bool single;  ///< losses and gradients in float

  std::string bfgs() const { return std::string("bfgs-") + id; }
  std::string jpo() const { return std::string("jpo-") + id; }
};

inline constexpr std::array<Setting, 5> kSettings{
    {{"f64-3", "double, 1e-3", 1e-3, false},
     {"f64-5", "double, 1e-5 (the suite's)", 1e-5, false},
     {"f64-7", "double, 1e-7", 1e-7, false},
     {"f32-5", "float, 1e-5", 1e-5, true},
     {"f32-7", "float, 1e-7", 1e-7, true}}};

}  // namespace physinv::billiards_precision
