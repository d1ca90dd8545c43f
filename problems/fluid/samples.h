/// Samples of a batch in the lanes of a register.
#pragma once

#include <limits>

#include "problems/fluid/plane.h"
#include "suite/core/blocks.h"

namespace physinv::fluid {

/// Lanes whose input is lost compute with zeros.
template <class T>
struct Block : SampleBlock {
  using P = Samples8<T>;
  static constexpr Index kCount = kWidth<T>;

  bool lost[kCount] = {};

  template <class... B>
  explicit Block(SampleBlock at, const B&... inputs) : SampleBlock(at) {
    const auto safe = [](const auto& v) {
      return (v.array().abs() <= T(1e6)).all();  // not so for NaN
    };
    for (Index k = 0; k < kCount; ++k)
      lost[k] = !(safe(inputs.col(column(k))) && ...);
  }

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

}  // namespace physinv::fluid
