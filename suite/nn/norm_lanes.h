/// Pieces of the loops over normalised channels (channel_norm.cpp and its
/// tangent): registers of samples at the positions of a pooling cell.
#pragma once

#include <array>
#include <cstddef>

#include "suite/core/simd/pack.h"
#include "suite/nn/channel_norm.h"

namespace physinv::nn {

/// The lanes of a row's last vector that hold samples.
template <class T>
struct SampleMask {
  using V = NarrowPack<T>;
  explicit SampleMask(Index samples)
      : full(samples / kNarrowLanes<T> * kNarrowLanes<T>) {
    V lane{};
    for (Index l = 0; l < kNarrowLanes<T>; ++l) lane[l] = static_cast<T>(l);
    valid = lane < broadcast<V>(static_cast<T>(samples - full));
  }
  V operator()(Index j, V v) const { return j < full ? v : (valid ? v : V{}); }
  Index full;
  decltype(V{} < V{}) valid;
};

/// The N positions of a pooling cell, as rows relative to its first one.
template <int N>
struct NormCell {
  explicit NormCell(const NormShape& s) : grid(s.grid) {
    for (int i = 0; i < N; ++i)
      row[static_cast<std::size_t>(i)] =
          (i % 2 + i / 2 * grid.columns) * s.channels;
  }
  Index first(Index output) const {
    if (N == 1) return output;
    if (N == 2) return 2 * output;
    const Index half = grid.columns / 2;
    return output / half * 2 * grid.columns + output % half * 2;
  }
  Grid grid;
  std::array<Index, N> row;
};

/// One channel's constants in registers, and its normalisation.
template <class T>
struct NormChannel {
  using V = NarrowPack<T>;
  NormChannel(const NormColumns<T>& at, const T* parameters, Index n, Index c)
      : mean(broadcast<V>(at.mean[c])),
        inverse(broadcast<V>(at.inverse[c])),
        factor(broadcast<V>(parameters[c] * at.inverse[c])),
        offset(broadcast<V>(parameters[n + c])) {}
  V operator()(V x) const { return fma_lanes(x - mean, factor, offset); }
  V mean, inverse, factor, offset;
};

/// Calls f with the cell size and whether the activation is a ReLU, both known
/// to the compiler.
template <class F>
void dispatch_norm(const NormShape& s, F&& f) {
  const bool relu = s.activation == Activation::relu;
  const auto with = [&]<int N>() {
    if (relu) {
      f.template operator()<N, true>();
    } else {
      f.template operator()<N, false>();
    }
  };
  if (!s.pool) {
    with.template operator()<1>();
  } else if (s.grid.flat()) {
    with.template operator()<2>();
  } else {
    with.template operator()<4>();
  }
}

}  // namespace physinv::nn
