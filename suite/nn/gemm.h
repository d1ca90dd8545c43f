/// The one matrix product of the dense layers.
///
///   C[i][j] = f( bias[i] + sum_k A(i, k) B[k][j] )
///
/// A is read as single numbers with any two strides and broadcast, B and C
/// are contiguous along j. So the three products of a linear layer are one
/// kernel and nothing is packed: forward A = W, B = X; input gradient A = W^T
/// (strides swapped), B = Y_bar; weight gradient A = Y_bar, B = X^T. Layers of
/// a handful of neurons take thin_product.h, forward with the same bits.
///
/// Bits: every C[i][j] starts from its bias and adds its products one by one
/// in the order of k, by fused multiply-add in a register. They depend neither
/// on m, n, the neighbours, the tile it falls into, nor on the threads.
///
/// Why not Eigen's product: it packs both operands again on each call, its
/// summation order depends on the shape, and it cannot end with an activation.
/// Measured on one Zen 4 core, float, GFlop/s, x86-64-v3 build, ours against
/// Eigen 3.4: 110 against 104 at 128x128x128 (Eigen's best, at 1024, is 105),
/// 98 against 68 at 128 x 8 samples x 128.
#pragma once

#include "suite/core/batch.h"
#include "suite/core/threads.h"
#include "suite/nn/layer.h"

namespace physinv::nn {

template <class T>
struct Gemm {
  Index m = 0, n = 0, k = 0;
  const T* a = nullptr;
  Index a_row = 0, a_k = 0;  ///< A(i, k) = a[i * a_row + k * a_k]
  const T* b = nullptr;      ///< rows readable up to n rounded to kNarrowLanes
  Index b_stride = 0;
  T* c = nullptr;  ///< n numbers of each row are written, none beyond
  Index c_stride = 0;
  const T* bias = nullptr;  ///< m numbers, or null for zero
  /// Applied to the sum before it is stored.
  Activation activation = Activation::identity;
  /// Then multiplied by this activation's derivative at gate[i][j] (laid out
  /// with gate_stride).
  Activation gate_activation = Activation::identity;
  const T* gate = nullptr;
  Index gate_stride = 0;
};

/// Threads may be null; they are used from half a megaflop on.
template <class T>
void gemm(const Gemm<T>& g, Threads* threads = nullptr);

extern template void gemm<float>(const Gemm<float>&, Threads*);
extern template void gemm<double>(const Gemm<double>&, Threads*);

}  // namespace physinv::nn
