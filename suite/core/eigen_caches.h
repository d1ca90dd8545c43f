/// Eigen cuts products into blocks by the caches that it believes in, and sums
/// block by block; without given sizes it asks the processor. These are the
/// same everywhere. Code that records what Eigen has summed over long rows
/// calls this first: the program around it may have set others.
#pragma once

#include <Eigen/Core>

namespace physinv {

inline void state_caches() {
  constexpr std::ptrdiff_t kFirst = 32 << 10, kSecond = 512 << 10,
                           kThird = 4 << 20;  // bytes
  if (Eigen::l1CacheSize() == kFirst && Eigen::l2CacheSize() == kSecond &&
      Eigen::l3CacheSize() == kThird)
    return;
  Eigen::setCpuCacheSizes(kFirst, kSecond, kThird);
}

}  // namespace physinv
