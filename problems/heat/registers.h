/// Fields a register at a time, and a thread's memory for it.
#pragma once

#include "problems/heat/plane_fft.h"
#include "suite/core/batch.h"
#include "suite/core/blocks.h"

namespace physinv::heat_lanes {

using P = Pack<double>;
inline constexpr Index kWidth = kLanes<double>;

struct Block : SampleBlock {
  template <class T>
  void load(BatchIn<T> batch, P* out) const {
    const T* from[kWidth];
    for (Index k = 0; k < kWidth; ++k) from[k] = batch.col(column(k)).data();
    for (Index r = 0; r < batch.rows(); ++r)
      for (Index k = 0; k < kWidth; ++k)
        out[r][k] = static_cast<double>(from[k][r]);
  }
  template <class T>
  void store(const P* in, BatchOut<T>& batch) const {
    for (Index k = 0; k < count; ++k) {
      T* const to = batch.col(first + k).data();
      for (Index r = 0; r < batch.rows(); ++r) to[r] = static_cast<T>(in[r][k]);
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

/// f(block, fields) for all samples, a register of them at a time.
template <class F>
void for_fields(const PlaneFft& fft,
                Scratch<double> memory,
                Threads* threads,
                Index samples,
                F&& f) {
  for_registers(threads, samples, kWidth, [&](SampleBlock at, int thread) {
    f(Block{at}, Fields(fft, memory.col(thread).data()));
  });
}

}  // namespace physinv::heat_lanes
