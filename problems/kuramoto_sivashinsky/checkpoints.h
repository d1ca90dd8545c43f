/// Runs of many steps, and the states that a tape keeps of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "problems/kuramoto_sivashinsky/etdrk2.h"
#include "suite/core/simd/math.h"
#include "suite/core/workspace.h"

namespace physinv {

/// Uninitialised, valid until the enclosing scope ends.
template <class P>
P* take_packs(Workspace& work, Index count) {
  using T = LaneScalar<P>;
  constexpr Index kWidth = sizeof(P) / sizeof(T);
  return reinterpret_cast<P*>(work.take<T>(kWidth, count).data());
}

/// Is no lane finite, of every kSide lanes the first?
template <Index kSide, class P>
bool all_lost(const P& v) {
  using T = LaneScalar<P>;
  constexpr Index kWidth = sizeof(P) / sizeof(T);
  const auto lost = beyond<T, kWidth>(v, std::numeric_limits<T>::max());
  Index count = 0;
  for (Index lane = 0; lane < kWidth; lane += kSide)
    count -= static_cast<Index>(lost[lane]);
  return count * kSide == kWidth;
}

/// Steps first .. last-1, from state(first) with its spectrum in r.s; returns
/// the last step reached. A point that is not finite spreads over its sample
/// in the next transform and never leaves it; a block ends with its last
/// sample.
template <class K, class P, class State, class Between>
Index march(const K& k,
            const Etdrk2Run<P>& r,
            Index first,
            Index last,
            State&& state,
            Between&& between) {
  for (Index i = first; i < last; ++i) {
    k.step(r, state(i), between(i), state(i + 1));
    if (all_lost<K::kSide>(state(i + 1)[0])) [[unlikely]]
      return i + 1;
  }
  return last;
}

/// How a tape keeps the states of a block: all of them, u_0 a_0 u_1 a_1 ..,
/// or state and spectrum at the start of every segment.
struct Keeping {
  Index segment, stride, rows;  ///< in steps, 0: all states; in packs

  /// `bytes` of a number.
  template <class K>
  Keeping(const KuramotoSivashinskyOptions& o,
          const K& k,
          Index samples,
          std::size_t bytes)
      : segment(0), stride(k.field()), rows((2 * o.steps + 1) * k.field()) {
    const Index numbers = samples * (2 * o.steps + 1) * o.cells;
    if (double(numbers) * double(bytes) <= o.tape_budget) return;
    segment = Index(std::ceil(std::sqrt(double(o.steps))));
    stride = k.field() + k.stride();
    rows = (o.steps + segment - 1) / segment * stride;
  }
};

/// All steps of one block back; states that were not kept are made again.
template <class K, class P>
void pull_steps(const K& k,
                const Etdrk2Run<P>& r,
                const Etdrk2Sums<P>& sums,
                Index steps,
                const Keeping& keep,
                const P* kept,
                Workspace& work) {
  const Index n = k.field();
  const auto back = [&](const P* states, Index count) {
    for (Index i = count; i-- > 0;)
      k.back_step(r, states + 2 * i * n, states + (2 * i + 1) * n, sums);
  };
  if (keep.segment == 0) return back(kept, steps);
  auto again = r;  // only the spectrum is its own
  again.s = take_packs<P>(work, k.stride());
  P* const states = take_packs<P>(work, (2 * keep.segment + 1) * n);
  const auto state = [=](Index i) { return states + 2 * i * n; };
  const auto between = [=](Index i) { return state(i) + n; };
  for (Index c = (steps - 1) / keep.segment; c >= 0; --c) {
    const Index count = std::min(keep.segment, steps - c * keep.segment);
    const P* const start = kept + c * keep.stride;
    std::copy_n(start, n, states);
    std::copy_n(start + n, k.stride(), again.s);
    march(k, again, 0, count, state, between);
    back(states, count);
  }
}

}  // namespace physinv
