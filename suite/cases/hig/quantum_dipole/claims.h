/// Claims of the quantum dipole's experiments (HIG paper, Figs. 4, 8 to 11).
#pragma once

#include <vector>

#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv::dipole {

inline constexpr const char* kDense = "hig/quantum-dipole";
inline constexpr const char* kConvolutional = "hig/quantum-dipole-cnn";

/// A1 to A6 and A8.
std::vector<ClaimResult> dense_claims(const Results& results);
/// A7.
ClaimResult convolutions_keep_the_order(const Results& results);

}  // namespace physinv::dipole
