/// The best estimate each example had at any time.
#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include "suite/core/archive.h"

namespace physinv {

template <class T>
class BestSoFar {
 public:
  /// Of nothing seen yet, the start is best.
  explicit BestSoFar(Batch<T> start)
      : x_(std::move(start)),
        loss_(Vector<T>::Constant(x_.cols(),
                                  std::numeric_limits<T>::infinity())) {}

  /// Losses are compared in the precision of training. False if none is finite.
  bool offer(const Batch<T>& x, const Vector<double>& losses) {
    bool finite = false;
    for (Index i = 0; i < losses.size(); ++i) {
      finite = finite || std::isfinite(losses(i));
      const T loss = static_cast<T>(losses(i));
      if (!(loss < loss_(i))) continue;  // NaN is never better
      loss_(i) = loss;
      x_.col(i) = x.col(i);
    }
    return finite;
  }

  const Batch<T>& x() const { return x_; }
  void serialize(Archive& archive) { archive(x_, loss_); }

 private:
  Batch<T> x_;
  Vector<T> loss_;
};

}  // namespace physinv
