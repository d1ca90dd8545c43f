/// Samples of a batch in the lanes of a register, a register at a time.
#pragma once

#include <algorithm>
#include <limits>

#include "problems/fluid/plane.h"
#include "suite/core/threads.h"
#include "suite/core/workspace.h"

namespace physinv::fluid {

/// Samples first .. first+count-1, one per lane; the last one fills the rest.
/// Lanes whose input is lost compute with zeros.
template <class T>
struct Block {
  using P = Samples8<T>;
  static constexpr Index kCount = kWidth<T>;

  Index first, count;
  bool lost[kCount] = {};

  template <class... B>
  explicit Block(Index begin, const B&... inputs) : first(begin), count(0) {
    ((count = std::min(kCount, inputs.cols() - begin)), ...);
    const auto safe = [](const auto& v) {
      return (v.array().abs() <= T(1e6)).all();  // not so for NaN
    };
    for (Index k = 0; k < kCount; ++k)
      lost[k] = !(safe(inputs.col(column(k))) && ...);
  }

  Index column(Index lane) const { return first + std::min(lane, count - 1); }
  P load(BatchIn<T> batch, Index row) const {
    P p{};
    for (Index k = 0; k < kCount; ++k)
      if (!lost[k]) p[k] = batch(row, column(k));
    return p;
  }
  void store(P p, BatchOut<T>& batch, Index row) const {
    for (Index k = 0; k < count; ++k)
      batch(row, first + k) =
          lost[k] ? std::numeric_limits<T>::quiet_NaN() : p[k];
  }
};

/// f(first, thread) for every register of samples.
template <class T, class F>
void for_registers(Threads* threads, Index samples, F&& f) {
  constexpr Index W = kWidth<T>;
  for_blocks(threads, (samples + W - 1) / W, [&](Index b, int thread) {
    f(b * W, thread);
  });
}

/// The same with a workspace of the thread's own.
template <class T, class F>
void for_registers(Workspace& work, Index samples, F&& f) {
  const bool threaded =
      work.threads() != nullptr && work.threads()->count() > 1;
  if (threaded) work.of_thread(0);  // makes all of them, before they run
  for_registers<T>(work.threads(), samples, [&](Index first, int thread) {
    Workspace& mine = threaded ? work.of_thread(thread) : work;
    const Workspace::Scope scope(mine);
    f(first, mine);
  });
}

}  // namespace physinv::fluid
