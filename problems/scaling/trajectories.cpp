#include "problems/scaling/trajectories.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "suite/core/check.h"
#include "suite/core/simd/pack.h"

namespace physinv {
namespace {

/// Registers of either coordinate: as many chains as fit, which hides what a
/// product takes.
constexpr int kPacks = kVectorBytes == 64 ? 8 : 4;
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
    case ScalingStep::inverse_simulator:
      break;
  }
  return {left, squared ? std::sqrt(std::max(left, 0.0)) : left, 0, false};
}

/// One block of trajectories, whole registers.
template <class T>
struct Block {
  const T *alpha, *start1, *start2;
  T *x1, *x2;

  Block at(Index i) const {
    return {alpha + i, start1 + i, start2 + i, x1 + i, x2 + i};
  }
};

template <bool cubic, class T>
void run(const Coefficients& c, Index steps, const Block<T>& block) {
  using P = Pack<T>;
  P u[kPacks], v[kPacks], k[kPacks];
  std::memcpy(u, block.start1, sizeof(u));
  std::memcpy(v, block.start2, sizeof(v));
  std::fill(k, k + kPacks, P{} + T(c.a));
  // Without b, alpha may be too large to be squared.
  for (int j = 0; c.b != 0 && j < kPacks; ++j) {
    P alpha;
    std::memcpy(&alpha, block.alpha + j * kLanes<T>, sizeof(alpha));
    k[j] = fma_lanes(T(c.b) * alpha, alpha, k[j]);
  }
  const T left = T(c.left);
  for (Index s = 0; s < steps; ++s)
    for (int j = 0; j < kPacks; ++j) {
      u[j] *= left;
      if constexpr (cubic) {
        v[j] = fma_lanes(k[j] * v[j], v[j] * v[j], v[j]);
      } else {
        v[j] *= k[j];
      }
    }
  std::memcpy(block.x1, u, sizeof(u));
  std::memcpy(block.x2, v, sizeof(v));
}

template <class T>
void run_share(const Coefficients& c,
               Index steps,
               Index count,
               const Block<T>& all) {
  constexpr Index kBlock = kPacks * kLanes<T>;
  const auto whole = [&](const Block<T>& block) {
    c.cubic ? run<true>(c, steps, block) : run<false>(c, steps, block);
  };
  Index i = 0;
  for (; i + kBlock <= count; i += kBlock) whole(all.at(i));
  if (i == count) return;
  const Block<T> rest = all.at(i);
  const Index left = count - i;
  T alpha[kBlock] = {}, x1[kBlock] = {}, x2[kBlock] = {};
  std::copy_n(rest.alpha, left, alpha);
  std::copy_n(rest.start1, left, x1);
  std::copy_n(rest.start2, left, x2);
  whole({alpha, x1, x2, x1, x2});
  std::copy_n(x1, left, rest.x1);
  std::copy_n(x2, left, rest.x2);
}

}  // namespace

template <class T>
void advance(const ScalingFlow& flow,
             VectorIn<T> alpha,
             VectorIn<T> start1,
             VectorIn<T> start2,
             VectorOut<T> x1,
             VectorOut<T> x2,
             Threads* threads) {
  SUITE_CHECK(flow.power == 1 || flow.power == 2, "power must be 1 or 2");
  const Index n = alpha.size();
  for (const Index size : {start1.size(), start2.size(), x1.size(), x2.size()})
    SUITE_CHECK(size == n, "there must be as many starts and ends as alphas");
  const Coefficients c = coefficients(flow);
  const Block<T> all{
      alpha.data(), start1.data(), start2.data(), x1.data(), x2.data()};
  for_blocks(threads, (n + kShare - 1) / kShare, [&](Index share, int) {
    const Index first = share * kShare;
    run_share(c, flow.steps, std::min(kShare, n - first), all.at(first));
  });
}

template decltype(advance<float>) advance<float>;
template decltype(advance<double>) advance<double>;

}  // namespace physinv
