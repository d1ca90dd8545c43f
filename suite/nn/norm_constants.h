/// Of batch normalisation, dense and by channel.
#pragma once

namespace physinv::nn {

inline constexpr double kNormEps = 1e-5;      ///< added to variances
inline constexpr double kNormMomentum = 0.1;  ///< of running statistics

}  // namespace physinv::nn
