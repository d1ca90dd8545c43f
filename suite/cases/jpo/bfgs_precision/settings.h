/// Precision and tolerance of BFGS and of the refinement, and the experiments
/// that they are varied on.
#pragma once

#include <string>
#include <vector>

namespace physinv::bfgs_precision {

struct Choice {
  const char* id;     ///< of the methods bfgs-ID and jpo-ID
  const char* title;  ///< precision, gtol
  double gtol;
  bool single;  ///< losses and gradients in float

  std::string bfgs() const { return std::string("bfgs-") + id; }
  std::string jpo() const { return std::string("jpo-") + id; }
};

struct Study {
  const char *name, *varied, *title;
  std::vector<Choice> choices;
};

/// Each with the suite's own setting and with float.
inline const std::vector<Study>& all_studies() {
  static const std::vector<Study> kStudies = {
      {"studies/billiards-precision",
       "jpo/billiards",
       "Billiards, precision and tolerance of BFGS",
       {{"f64-3", "double, 1e-3", 1e-3, false},
        {"f64-5", "double, 1e-5 (the suite's)", 1e-5, false},
        {"f64-7", "double, 1e-7", 1e-7, false},
        {"f32-5", "float, 1e-5", 1e-5, true},
        {"f32-7", "float, 1e-7", 1e-7, true}}},
      {"studies/wave-packet-precision",
       "jpo/wave-packet",
       "Wave packet, precision and tolerance of BFGS",
       {{"f64-3", "double, 1e-3", 1e-3, false},
        {"f64-5", "double, 1e-5 (the suite's)", 1e-5, false},
        {"f64-7", "double, 1e-7", 1e-7, false},
        {"f32-3", "float, 1e-3", 1e-3, true},
        {"f32-5", "float, 1e-5", 1e-5, true}}},
      {"studies/kuramoto-sivashinsky-precision",
       "jpo/kuramoto-sivashinsky",
       "Kuramoto-Sivashinsky, precision and tolerance of BFGS",
       {{"f64-5", "double, 1e-5", 1e-5, false},
        {"f64-7", "double, 1e-7", 1e-7, false},
        {"f64-10", "double, 1e-10 (the suite's)", 1e-10, false},
        {"f64-12", "double, 1e-12", 1e-12, false},
        {"f32-5", "float, 1e-5", 1e-5, true}}},
      {"studies/robotic-arm-precision",
       "jpo/robotic-arm",
       "Robotic arm, precision and tolerance of BFGS",
       {{"f64-5", "double, 1e-5", 1e-5, false},
        {"f64-7", "double, 1e-7", 1e-7, false},
        {"f64-10", "double, 1e-10 (the suite's)", 1e-10, false},
        {"f32-5", "float, 1e-5", 1e-5, true},
        {"f32-7", "float, 1e-7", 1e-7, true}}},
      {"studies/navier-stokes-precision",
       "jpo/navier-stokes",
       "Navier-Stokes, precision and tolerance of BFGS",
       {{"f64-2", "double, 1e-2", 1e-2, false},
        {"f64-3", "double, 1e-3 (the suite's)", 1e-3, false},
        {"f64-5", "double, 1e-5", 1e-5, false},
        {"f32-3", "float, 1e-3", 1e-3, true}}}};
  return kStudies;
}

}  // namespace physinv::bfgs_precision
