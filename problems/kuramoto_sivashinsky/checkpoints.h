/// Runs of many steps, and the states that a tape keeps of them.
#pragma once

#include <algorithm>
#include <cmath>

#include "problems/kuramoto_sivashinsky/etdrk2.h"

namespace physinv {

/// Steps first .. last-1, from state(first) with its spectrum in r.s; returns
/// the last step reached. A point that is not finite spreads over its sample
/// in the next transform and never leaves it.
template <class T, class State, class Between>
Index march(const Etdrk2<T>& k,
            const typename Etdrk2<T>::Run& r,
            Index first,
            Index last,
            State&& state,
            Between&& between) {
  for (Index i = first; i < last; ++i) {
    k.step(r, state(i), between(i), state(i + 1));
    if (!std::isfinite(state(i + 1)[0])) [[unlikely]]
      return i + 1;
  }
  return last;
}

/// How a tape keeps the states of a sample: all of them, u_0 a_0 u_1 a_1 ..,
/// or state and spectrum at the start of every segment.
struct Keeping {
  Index segment, stride, rows;  ///< in steps, 0: all states; in reals

  template <class T>
  Keeping(const KuramotoSivashinskyOptions& o,
          const Etdrk2<T>& k,
          Index samples)
      : segment(0), stride(o.cells), rows((2 * o.steps + 1) * o.cells) {
    if (double(samples * rows) * sizeof(T) <= o.tape_budget) return;
    segment = Index(std::ceil(std::sqrt(double(o.steps))));
    stride = o.cells + k.stride();
    rows = (o.steps + segment - 1) / segment * stride;
  }
};

/// All steps of one sample back; states that were not kept are made again.
template <class T>
void pull_steps(const Etdrk2<T>& k,
                const typename Etdrk2<T>::Run& r,
                const typename Etdrk2<T>::Sums& sums,
                Index steps,
                const Keeping& keep,
                const T* kept,
                Workspace& work) {
  const Index n = k.cells();
  const auto back = [&](const T* states, Index count) {
    for (Index i = count; i-- > 0;)
      k.back_step(r, states + 2 * i * n, states + (2 * i + 1) * n, sums);
  };
  if (keep.segment == 0) return back(kept, steps);
  auto again = r;  // only the spectrum is its own
  again.s = work.take<T>(k.stride(), 1).data();
  T* const states = work.take<T>((2 * keep.segment + 1) * n, 1).data();
  const auto state = [=](Index i) { return states + 2 * i * n; };
  const auto between = [=](Index i) { return state(i) + n; };
  for (Index c = (steps - 1) / keep.segment; c >= 0; --c) {
    const Index count = std::min(keep.segment, steps - c * keep.segment);
    const T* const start = kept + c * keep.stride;
    std::copy_n(start, n, states);
    std::copy_n(start + n, n + 2, again.s);
    march(k, again, 0, count, state, between);
    back(states, count);
  }
}

}  // namespace physinv
