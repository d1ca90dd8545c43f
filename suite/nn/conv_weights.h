/// The weight gradient of a convolution (see conv_kernels.h). Its tiles are
/// whole vectors over samples; nothing is transposed before the lanes are added
/// up at the end.
#pragma once

#include "suite/nn/conv_kernels.h"

namespace physinv::nn {

/// Number of partial sums that `accumulate_weights` needs.
template <class T>
Index weight_sums(const ConvShape& shape);

/// sums += y_bar[p][o] x[p + t][c] over positions [begin, end), a vector of
/// samples each. Padding lanes of y_bar must be zero, of x finite.
template <class T>
void accumulate_weights(const ConvShape& shape,
                        const std::vector<Run>& runs,
                        Lanes<const T> x,
                        Lanes<const T> y_bar,
                        Index begin,
                        Index end,
                        T* sums);

/// totals += the vectors of an array of sums, lane after lane: [out][tap][in].
template <class T>
void add_weights(const ConvShape& shape, const T* sums, T* totals);

/// weights_bar [out][in][tap] from such totals.
template <class T>
void order_weights(const ConvShape& shape, const T* totals, T* weights_bar);

/// Both, of `parts` arrays of sums. totals: room for as many.
template <class T>
void finish_weights(const ConvShape& shape,
                    const T* sums,
                    Index parts,
                    T* totals,
                    T* weights_bar);

/// Positions of a block that should stay in the L1 cache, by shape and samples
/// alone.
template <class T>
Index positions_per_block(Lanes<const T> x, Index channels);

}  // namespace physinv::nn
