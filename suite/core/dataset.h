/// Samples of a problem, and the hash that identifies them.
#pragma once

#include <cstdint>

#include "suite/core/batch.h"

namespace physinv {

template <class T>
struct Samples {
  Batch<T> x;      ///< unknowns; no rows where the truth is not known
  Batch<T> y;      ///< observations
  Batch<T> given;  ///< side input; may have no rows

  Index count() const { return y.cols(); }

  template <class U>
  Samples<U> cast() const {
    return {
        x.template cast<U>(), y.template cast<U>(), given.template cast<U>()};
  }
};

/// Hash of shapes and bytes.
std::uint64_t content_hash(const Samples<double>& samples);

}  // namespace physinv
