/// Registers of samples: how columns get into them and out, and the loop over
/// all of them.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>

#include "problems/kuramoto_sivashinsky/etdrk2.h"
#include "suite/core/threads.h"
#include "suite/core/workspace.h"

namespace physinv {

/// Samples first .. first+count-1, one per lane of P; the last one fills what
/// is left of the pack.
template <class T, class P>
struct Block {
  static constexpr Index kWidth = sizeof(P) / sizeof(T);

  const Etdrk2<T>& k;
  Index first, count;

  Index column(Index lane) const { return first + std::min(lane, count - 1); }

  void load(BatchIn<T> batch, P* out) const {
    for (Index r = 0; r < batch.rows(); ++r)
      for (Index lane = 0; lane < kWidth; ++lane)
        out[r][lane] = batch(r, column(lane));
  }
  void store(const P* in, Index lane, Eigen::Ref<Vector<T>> out) const {
    for (Index r = 0; r < out.size(); ++r) out(r) = in[r][lane];
  }
  /// Last states go out, as NaN unless all of one is finite.
  void finish(const P* u, BatchOut<T>& y) const {
    for (Index lane = 0; lane < count; ++lane) {
      auto column = y.col(first + lane);
      store(u, lane, column);
      if (!column.allFinite())
        column.setConstant(std::numeric_limits<T>::quiet_NaN());
    }
  }
  /// Of unknowns x, in 3 `stride` packs of memory.
  Etdrk2Run<P> run(BatchIn<T> x, P* memory) const {
    P unknowns[2];
    load(x, unknowns);
    const Index h = k.stride();
    return {unknowns[0], unknowns[1], memory, memory + h, memory + 2 * h};
  }
};

/// Calls f(block, thread) for all samples, a register of them at a time.
template <class T, class F>
void for_registers(const Etdrk2<T>& k, Threads* threads, Index count, F&& f) {
  constexpr Index W = kLanes<T>;
  for_blocks(threads, (count + W - 1) / W, [&](Index b, int thread) {
    const Index first = b * W, some = std::min(W, count - first);
    with_pack<T>(some, [&]<class P>(P) {
      f(Block<T, P>{k, first, some}, thread);
    });
  });
}

/// Runs body(block, workspace) for all samples; returns the sum of what the
/// bodies return.
template <class T, class F>
std::uint64_t sum_blocks(const Etdrk2<T>& k,
                         Workspace& work,
                         Index count,
                         F&& body) {
  const bool threaded =
      work.threads() != nullptr && work.threads()->count() > 1;
  if (threaded) work.of_thread(0);  // makes all of them, before they run
  std::atomic<std::uint64_t> sum = 0;
  for_registers(k, work.threads(), count, [&](const auto& block, int thread) {
    Workspace& mine = threaded ? work.of_thread(thread) : work;
    const Workspace::Scope scope(mine);
    sum += static_cast<std::uint64_t>(body(block, mine));
  });
  return sum;
}

}  // namespace physinv
