/// Names of what is compared on the oscillators.
#pragma once

#include <string>
#include <vector>

#include "suite/evidence/runs.h"

namespace physinv::oscillators {

inline constexpr const char* kName = "hig/oscillators";

/// Fig. 12b, b = 64.
struct Exponent {
  const char* id;
  double kappa;
};
inline constexpr Exponent kExponents[] = {{"kappa-1", 1},
                                          {"kappa-05", 0.5},
                                          {"kappa-025", 0.25},
                                          {"kappa-0", 0},
                                          {"kappa-m025", -0.25},
                                          {"kappa-m05", -0.5},
                                          {"kappa-m075", -0.75},
                                          {"kappa-m1", -1}};

/// Figs. 5 and 6: rates and batch sizes of the first-order rules.
struct Grid {
  const char* rule;
  std::vector<double> rates;
};
inline const std::vector<Grid> kGrids = {{"adadelta", {0.1, 1, 10}},
                                         {"adagrad", {0.01, 0.1, 1}},
                                         {"sgd", {0.01, 0.1, 1}},
                                         {"rmsprop", {1e-5, 1e-4, 1e-3}},
                                         {"adam", {1e-4, 3e-4, 1e-3, 3e-3}}};
inline constexpr Index kGridBatches[] = {256, 512, 1024};
std::string grid_id(const char* rule, double rate, Index batch);

/// Methods whose name begins so.
std::vector<std::string> ids_with(const std::string& beginning);

/// Where Table 3 has the seconds of an update by the method of a run. Other
/// first-order rules are taken for as long as Adam, Gauss-Newton as HIG.
std::string update_row(const Run& run);

}  // namespace physinv::oscillators
