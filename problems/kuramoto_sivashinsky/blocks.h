/// Registers of samples: how columns get into them and out, and the loop over
/// all of them.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>

#include "problems/kuramoto_sivashinsky/etdrk2.h"
#include "suite/core/blocks.h"

namespace physinv {

template <class T, class P>
struct Block : SampleBlock {
  static constexpr Index kWidth = sizeof(P) / sizeof(T);

  const Etdrk2<T>& k;

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

/// Calls f(block, own) for all samples, a register of them at a time: `own` is
/// the thread, or its workspace, as `work` is Threads* or a Workspace.
template <class T, class Work, class F>
void for_packs(const Etdrk2<T>& k, Work&& work, Index samples, F&& f) {
  for_registers(work, samples, kLanes<T>, [&](SampleBlock at, auto&& own) {
    with_pack<T>(at.count, [&]<class P>(P) { f(Block<T, P>{at, k}, own); });
  });
}

/// Runs body(block, workspace) for all samples; returns the sum of what the
/// bodies return.
template <class T, class F>
std::uint64_t sum_blocks(const Etdrk2<T>& k,
                         Workspace& work,
                         Index samples,
                         F&& body) {
  std::atomic<std::uint64_t> sum = 0;
  for_packs(k, work, samples, [&](const auto& block, Workspace& own) {
    sum += static_cast<std::uint64_t>(body(block, own));
  });
  return sum;
}

}  // namespace physinv
