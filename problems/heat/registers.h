/// Fields a register at a time, and a thread's memory for it.
#pragma once

#include <algorithm>

#include "problems/heat/plane_fft.h"
#include "suite/core/batch.h"
#include "suite/core/threads.h"
#include "suite/core/workspace.h"

namespace physinv::heat_lanes {

using P = Pack<double>;
inline constexpr Index kWidth = kLanes<double>;

/// Fields first .. first+count-1, one per lane; the last one fills what is left
/// of the register.
struct Block {
  Index first, count;

  template <class T>
  void load(BatchIn<T> batch, P* out) const {
    const T* column[kWidth];
    for (Index k = 0; k < kWidth; ++k)
      column[k] = batch.col(first + std::min(k, count - 1)).data();
    for (Index r = 0; r < batch.rows(); ++r)
      for (Index k = 0; k < kWidth; ++k)
        out[r][k] = static_cast<double>(column[k][r]);
  }
  template <class T>
  void store(const P* in, BatchOut<T>& batch) const {
    for (Index k = 0; k < count; ++k) {
      T* const column = batch.col(first + k).data();
      for (Index r = 0; r < batch.rows(); ++r)
        column[r] = static_cast<T>(in[r][k]);
    }
  }
};

/// The parts of a thread's memory.
struct Fields {
  P *u, *v, *z, *scratch;

  static Index numbers(const PlaneFft& fft) {
    return kWidth * (2 * fft.field() + fft.spectrum() + fft.scratch());
  }
  Fields(const PlaneFft& fft, double* memory)
      : u(reinterpret_cast<P*>(memory)),
        v(u + fft.field()),
        z(v + fft.field()),
        scratch(z + fft.spectrum()) {}
};

inline Index count_of(const Threads* threads) {
  return threads != nullptr ? threads->count() : 1;
}

inline Index registers(Index samples) {
  return (samples + kWidth - 1) / kWidth;
}

/// f(block, fields) for all samples, a register of them at a time.
template <class F>
void for_registers(const PlaneFft& fft,
                   Scratch<double> memory,
                   Threads* threads,
                   Index samples,
                   F&& f) {
  for_blocks(threads, registers(samples), [&](Index b, int thread) {
    const Index first = b * kWidth;
    f(Block{first, std::min(kWidth, samples - first)},
      Fields(fft, memory.col(thread).data()));
  });
}

}  // namespace physinv::heat_lanes
