/// Level-3 and level-2 kernels on a symmetric matrix of which one triangle is
/// stored: memory row r holds the columns c >= r, contiguous (the lower
/// triangle of a column-major matrix). What lies at c < r is scratch.
#pragma once

#include <vector>

#include "suite/core/batch.h"

namespace physinv {
class Threads;
}

namespace physinv::linalg {

/// Rows are padded: zeros from column n to the next multiple of the tiles.
struct Symmetric {
  double* data;
  Index n, stride;
  double* row(Index r) const { return data + r * stride; }
};

/// Numbers from one padded row to the next: a multiple of 16, and an odd
/// number of double cache lines, so that columns do not share few cache sets.
Index padded_stride(Index n);

/// Below this many rows a product with a vector is over too soon for threads.
inline constexpr Index kThreadRows = 1024;

/// y = A x on rows and columns >= first, for x that is padded like a row and
/// zero before `first`; y is written from `first` on (and up to its padding).
/// `parts` is scratch. The order of the sums depends on n and first only.
class SymmetricProduct {
 public:
  void operator()(
      Symmetric a, Index first, const double* x, double* y, Threads* threads);

 private:
  std::vector<double> parts_;
};

/// A -= sum_k V_k W_k^T + W_k V_k^T on rows and columns >= first; V_k and W_k
/// are memory rows of `count` x stride, padded with zeros.
class RankUpdate {
 public:
  void operator()(Symmetric a,
                  Index first,
                  const double* v,
                  const double* w,
                  Index stride,
                  Index count,
                  Threads* threads);

 private:
  std::vector<double> rows_, columns_;
};

}  // namespace physinv::linalg
