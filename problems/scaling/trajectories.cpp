#include "problems/scaling/trajectories.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "suite/core/check.h"
#include "suite/core/lanes.h"

namespace physinv {
namespace {

/// Registers of either coordinate: enough chains to hide what a product takes.
constexpr int kPacks = 4;
/// Trajectories that one thread takes at a time.
constexpr Index kShare = 4096;

/// What a step does to x1, and to x2 of a trajectory: x2 *= a + b alpha^2, or
/// x2 += (a + b alpha^2) x2^3.
struct Coefficients {
  double left, a, b;
  bool cubic;
};

Coefficients coefficients(const ScalingFlow& f) {
  const double c = f.half ? 1 : 2, left = 1 - f.rate;
  const bool squared = f.power == 2;
  switch (f.step) {
    case ScalingStep::gradient:
      if (squared) return {1 - c * f.rate, 0, -2 * c * f.rate, true};
      return {1 - c * f.rate, 1, -c * f.rate, false};
    case ScalingStep::newton:
      return {left, squared ? 1 - f.rate / 3 : left, 0, false};
    case ScalingStep::inverse_gradient:
      return {left, squared ? 1 - f.rate / 2 : left, 0, false};
    case ScalingStep::inverse_simulator: break;
  }
  return {left, squared ? std::sqrt(std::max(left, 0.0)) : left, 0, false};
}

template <bool cubic, class T>
void run(const Coefficients& c, Index steps, const T* alpha, T* x1, T* x2) {
  using P = Pack<T>;
  P u[kPacks], v[kPacks], k[kPacks];
  std::memcpy(u, x1, sizeof(u)), std::memcpy(v, x2, sizeof(v));
  std::memcpy(k, alpha, sizeof(k));
  const T left = T(c.left);
  // Without b, alpha may be too large to be squared.
  for (P& p : k) p = c.b == 0 ? P{} + T(c.a) : fma_lanes(T(c.b) * p, p, P{} + T(c.a));
  for (Index s = 0; s < steps; ++s)
    for (int j = 0; j < kPacks; ++j) {
      u[j] *= left;
      if constexpr (cubic) {
        v[j] = fma_lanes(k[j] * v[j], v[j] * v[j], v[j]);
      } else {
        v[j] *= k[j];
      }
    }
  std::memcpy(x1, u, sizeof(u)), std::memcpy(x2, v, sizeof(v));
}

template <class T>
void run_share(const Coefficients& c,
               Index steps,
               Index count,
               const T* alpha,
               T* x1,
               T* x2) {
  constexpr Index kBlock = kPacks * kLanes<T>;
  const auto block = [&](const T* a, T* u, T* v) {
    c.cubic ? run<true>(c, steps, a, u, v) : run<false>(c, steps, a, u, v);
  };
  Index i = 0;
  for (; i + kBlock <= count; i += kBlock) block(alpha + i, x1 + i, x2 + i);
  if (i == count) return;
  T a[kBlock] = {}, u[kBlock] = {}, v[kBlock] = {};
  std::copy(alpha + i, alpha + count, a);
  std::copy(x1 + i, x1 + count, u);
  std::copy(x2 + i, x2 + count, v);
  block(a, u, v);
  std::copy(u, u + (count - i), x1 + i);
  std::copy(v, v + (count - i), x2 + i);
}

}  // namespace

template <class T>
void advance(const ScalingFlow& flow,
             VectorIn<T> alpha,
             VectorOut<T> x1,
             VectorOut<T> x2,
             Threads* threads) {
  SUITE_CHECK(flow.power == 1 || flow.power == 2, "power must be 1 or 2");
  const Index n = alpha.size();
  SUITE_CHECK(x1.size() == n && x2.size() == n, "sizes differ");
  const Coefficients c = coefficients(flow);
  for_blocks(threads, (n + kShare - 1) / kShare, [&](Index share, int) {
    const Index first = share * kShare;
    run_share(c,
              flow.steps,
              std::min(kShare, n - first),
              alpha.data() + first,
              x1.data() + first,
              x2.data() + first);
  });
}

template void advance<float>(const ScalingFlow&,
                             VectorIn<float>,
                             VectorOut<float>,
                             VectorOut<float>,
                             Threads*);
template void advance<double>(const ScalingFlow&,
                              VectorIn<double>,
                              VectorOut<double>,
                              VectorOut<double>,
                              Threads*);

}  // namespace physinv
