/// Whether numbers are finite, a register at a time.
#pragma once

#include <limits>

#include "suite/core/simd/pack.h"

namespace physinv {

/// Are these n numbers finite?
template <class T>
bool all_finite(const T* x, Index n) {
  Mask<T, kLanes<T>> found{};
  for_pieces<Pack<T>>(n, [&](Index i, auto lanes) {
    found |= beyond(load_lanes<Pack<T>>(x + i, lanes),
                    std::numeric_limits<T>::max());
  });
  return !any(found);
}

}  // namespace physinv
