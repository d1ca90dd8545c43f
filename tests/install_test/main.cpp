#include <cmath>
#include <cstdio>

#include "suite/core/batch.h"
#include "suite/core/rng.h"
#include "suite/harness/build_info.h"

#if (defined(__x86_64__) && !defined(__AVX2__)) || \
    !defined(EIGEN_DONT_PARALLELIZE) || !defined(EIGEN_DONT_VECTORIZE)
#error "the package must carry the flags that change Eigen's alignment and sums"
#endif

int main() {
  auto stream = physinv::Rng::root("install/consumer", 0).stream();
  physinv::Batch<double> x(3, 4);
  for (double& entry : x.reshaped()) entry = stream.normal();
  const auto info = physinv::build_info();
  std::printf("%s %s: norm %g\n",
              info.version.data(),
              info.fingerprint.data(),
              x.norm());
  return std::isfinite(x.norm()) && info.fingerprint.size() == 16 ? 0 : 1;
}
