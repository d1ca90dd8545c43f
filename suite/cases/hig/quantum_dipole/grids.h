/// The quantum dipole's experiments, their methods as points of grids (HIG
/// paper, Figs. 8 to 11).
#pragma once

#include <string>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/power_of_ten.h"

namespace physinv::dipole {

inline constexpr const char* kDense = "hig/quantum-dipole";
inline constexpr const char* kConvolutional = "hig/quantum-dipole-cnn";
inline constexpr const char* kDirect = "hig/quantum-dipole-direct";

/// A grid's point; `id` is the method.
struct AdamPoint {
  Index batch;
  double rate;
  std::string id;
};

struct HigPoint {
  Index batch;
  double rate;
  int digits;  ///< tau = 10^-digits
  std::string id;

  double tau() const { return math::power_of_ten(-digits); }
};

/// HIG in float, with the gradient projected or raw: once trained, most of g
/// lies in the Jacobian's null space, where it acts by rounding alone.
struct FloatPoint {
  int digits;  ///< tau = 10^-digits
  bool project;
  std::string id;
};

std::vector<FloatPoint> in_float();

std::string adam_id(Index batch, double rate);

/// Dense layers: Figs. 8 and 9.
std::vector<AdamPoint> dense_adam();
std::vector<HigPoint> dense_hig();
/// Convolutions: Figs. 10 and 11.
std::vector<AdamPoint> conv_adam();
std::vector<HigPoint> conv_hig();

}  // namespace physinv::dipole
