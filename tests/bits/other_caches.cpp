/// Eigen's caches as on another processor, in place of those that the suite
/// states (suite/core/eigen_caches.h). Linked last, so that it runs last before
/// main.
#include <Eigen/Core>

extern "C" int physinv_other_caches;
int physinv_other_caches = [] {
  constexpr int kSmall = 8 << 10, kMiddle = 64 << 10, kLarge = 1 << 20;
  Eigen::setCpuCacheSizes(kSmall, kMiddle, kLarge);
  return kSmall;
}();
