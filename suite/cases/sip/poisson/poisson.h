/// The grids of the Poisson experiments: that of the authors' code, that of the
/// paper, and a small one for methods that take long.
#pragma once

#include "suite/core/batch.h"

namespace physinv::poisson {

struct Domain {
  Index rows, columns;
  const char *experiment, *title;
};

inline constexpr Domain kPlane{64, 64, "sip/poisson", "Poisson, 64 x 64"};
inline constexpr Domain kSmall{32, 32, "sip/poisson-32", "Poisson, 32 x 32"};
inline constexpr Domain kPaper{80, 60, "sip/poisson-80x60", "Poisson, 80 x 60"};
inline constexpr Domain kFno{
    64, 64, "sip/poisson-fno", "Poisson, 64 x 64, Fourier neural operator"};
inline constexpr Domain kNarrow{
    64, 64, "sip/poisson-fno-16", "Poisson, 64 x 64, operator of width 16"};

}  // namespace physinv::poisson
