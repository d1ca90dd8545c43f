/// Eigen cuts products into blocks by the caches that it believes in, and sums
/// block by block; unless told, it asks the processor. These are stated for
/// everybody. Who records what Eigen has summed over long rows calls this
/// first: the program around may have told Eigen others.
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
