/// Registers of samples: how columns get into them and out, and the loop over
/// all of them.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>

#include "problems/kuramoto_sivashinsky/etdrk2.h"
#include "suite/core/blocks.h"

namespace physinv {

template <class K, class P>
struct Block : SampleBlock {
  using T = LaneScalar<P>;
  static constexpr Index kWidth = sizeof(P) / sizeof(T);

  const K& k;

  void load(BatchIn<T> fields, P* out) const {
    for (Index r = 0; r < fields.rows(); ++r) {
      const Index at = K::point(r);
      for (Index lane = 0; lane < kWidth; lane += K::kSide)
        out[at / K::kSide][lane + at % K::kSide] =
            fields(r, column(lane / K::kSide));
    }
  }
  void store(const P* in, Index sample, Eigen::Ref<Vector<T>> out) const {
    for (Index r = 0; r < out.size(); ++r) {
      const Index at = K::point(r);
      out(r) = in[at / K::kSide][sample * K::kSide + at % K::kSide];
    }
  }
  /// Last states are written, as NaN unless all of one is finite.
  void finish(const P* u, BatchOut<T>& y) const {
    for (Index sample = 0; sample < count; ++sample) {
      auto column = y.col(first + sample);
      store(u, sample, column);
      if (!column.allFinite())
        column.setConstant(std::numeric_limits<T>::quiet_NaN());
    }
  }
  /// Of unknowns x, in 3 `stride` packs of memory.
  Etdrk2Run<P> run(BatchIn<T> x, P* memory) const {
    const Index h = k.stride();
    return {all_of(x, 0), all_of(x, 1), memory, memory + h, memory + 2 * h};
  }
  /// Forcing terms that so many steps leave out, as alpha is 0 in every lane.
  std::uint64_t unforced(const Etdrk2Run<P>& r, Index steps) const {
    const bool none = count_set(r.alpha == P{}) == kWidth;
    return none ? static_cast<std::uint64_t>(steps * count) : 0;
  }

 private:
  /// Row r in all lanes of each sample.
  P all_of(BatchIn<T> x, Index r) const {
    P v{};
    for (Index lane = 0; lane < kWidth; ++lane)
      v[lane] = x(r, column(lane / K::kSide));
    return v;
  }
};

/// Calls f(block, own) for all samples, a register of them at a time, or few
/// (samples_together): `own` is the thread, or its workspace, as `work` is
/// Threads* or a Workspace.
template <class T, class Work, class F>
void for_packs(const Etdrk2Kernels<T>& kernels,
               Work&& work,
               Index samples,
               F&& f) {
  for_registers(work, samples, kLanes<T>, [&](SampleBlock at, auto&& own) {
    const Index end = at.first + at.count;
    const Index step = samples_together(kernels, at.count);
    for (Index first = at.first; first < end; first += step) {
      const SampleBlock few{first, std::min(step, end - first)};
      with_pack(kernels, few.count, [&]<class K, class P>(const K& k, P) {
        f(Block<K, P>{few, k}, own);
      });
    }
  });
}

/// Runs body(block, workspace) for all samples; returns the sum of what the
/// bodies return.
template <class T, class F>
std::uint64_t sum_blocks(const Etdrk2Kernels<T>& k,
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
