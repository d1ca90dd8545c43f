/// The weight gradient of a convolution (see conv_kernels.h). Its tiles are
/// whole vectors over samples; nothing is transposed before the lanes are added
/// up at the end.
#pragma once

#include <algorithm>
#include <vector>

#include "suite/core/workspace.h"
#include "suite/nn/conv_kernels.h"

namespace physinv::nn {

/// Number of partial sums that `accumulate_weights` needs.
template <class T>
Index weight_sums(const ConvShape& shape);

/// sums += y_bar[p][o] x[p + t][c] over positions [begin, end), a vector of
/// samples each. Padding lanes of y_bar must be zero, of x finite.
template <class T>
void accumulate_weights(const ConvShape& shape,
                        const std::vector<WindowRun>& runs,
                        Rows<const T> x,
                        Rows<const T> y_bar,
                        Index begin,
                        Index end,
                        T* sums);

/// totals += the vectors of an array of sums, lane after lane: [out][tap][in].
template <class T>
void add_weights(const ConvShape& shape, const T* sums, T* totals);

/// weights_bar [out][in][tap] from such totals.
template <class T>
void order_weights(const ConvShape& shape, const T* totals, T* weights_bar);

/// The weight gradient's partial sums: an array a part, or one for all parts if
/// they come in turn, which then stays in the caches.
template <class T>
class WeightSums {
 public:
  WeightSums(const ConvShape& shape, Index parts, bool in_turn, Workspace& work)
      : shape_(shape),
        parts_(parts),
        in_turn_(in_turn),
        size_(weight_sums<T>(shape)),
        sums_(work.take<T>(size_, in_turn ? 1 : parts).data()),
        totals_(work.take<T>(shape.weights(), 1).data()) {
    std::fill_n(totals_, shape.weights(), T(0));
  }

  /// Zeros to add to.
  T* begin(Index part) const {
    T* const sums = at(part);
    std::fill_n(sums, size_, T(0));
    return sums;
  }
  void end(Index part) const {
    if (in_turn_) add_weights(shape_, at(part), totals_);
  }
  void finish(T* weights_bar) const {
    for (Index part = 0; part < parts_ && !in_turn_; ++part)
      add_weights(shape_, at(part), totals_);
    order_weights(shape_, totals_, weights_bar);
  }

 private:
  T* at(Index part) const { return sums_ + (in_turn_ ? 0 : part * size_); }

  const ConvShape& shape_;
  Index parts_;
  bool in_turn_;
  Index size_;
  T* sums_;
  T* totals_;
};

/// Positions of a block that should stay in the L1 cache, by shape and samples
/// alone.
template <class T>
Index positions_per_block(Rows<const T> x, Index channels);

}  // namespace physinv::nn
