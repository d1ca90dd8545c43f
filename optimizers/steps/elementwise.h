/// The frame of first-order update rules: one pass over parameters x, gradient
/// g and what the rule keeps, some numbers per parameter, a register at a time.
///
///   template <class T>
///   class Plain : public ElementwiseStep<T, Plain<T>, 0> { ...
///     /// x <- f(x, g), of the step of this number (1, 2, ..)
///     auto update(long) const {
///       return [rate = ...](auto x, auto g) { return x - rate * g; };
///     }
///   };
///
/// `update` returns a function of registers x, g and references to those kept,
/// which gives the new x; it captures by value. What is kept starts as
/// `initial` on the first step. An object belongs to one vector.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "suite/core/archive.h"
#include "suite/core/batch.h"
#include "suite/core/check.h"
#include "suite/core/simd/pack.h"

namespace physinv {

template <class T, class Rule, std::size_t kKept>
class ElementwiseStep {
 public:
  static constexpr auto kNumbersPerParameter = static_cast<Index>(kKept);

  void step(VectorOut<T> x, VectorIn<T> gradient) { step(x, gradient, x); }
  /// Leaves x and writes the new one to `to`, which may be the gradient.
  void step(VectorIn<T> x, VectorIn<T> gradient, VectorOut<T> to) {
    SUITE_CHECK(x.size() == gradient.size() && x.size() == to.size(),
                "vectors must have the same size");
    if (steps_ == 0)
      for (auto& k : kept_) k.setConstant(x.size(), initial_);
    for (const auto& k : kept_)
      SUITE_CHECK(x.size() == k.size(),
                  "the size of the vector must not change");
    ++steps_;
    sweep(static_cast<const Rule&>(*this).update(steps_),
          x,
          gradient,
          to,
          std::make_index_sequence<kKept>());
  }

  /// Forgets what is kept; the next step is a first one.
  void reset() { steps_ = 0; }
  void serialize(Archive& archive) {
    for (auto& k : kept_) archive(k);
    archive(steps_);
  }

 protected:
  explicit ElementwiseStep(T initial = 0) : initial_(initial) {}

 private:
  template <class Update, std::size_t... k>
  void sweep(Update update,
             VectorIn<T> x,
             VectorIn<T> gradient,
             VectorOut<T> to,
             std::index_sequence<k...>) {
    using V = Pack<T>;
    T* const out = to.data();
    const T *const px = x.data(), *const pg = gradient.data();
    const std::array<T*, kKept> p = {kept_[k].data()...};
    for_pieces<V>(x.size(), [=](Index i, auto lanes) {
      std::array<V, kKept> kept = {load_lanes<V>(p[k] + i, lanes)...};
      const auto next = update(load_lanes<V>(px + i, lanes),
                               load_lanes<V>(pg + i, lanes),
                               kept[k]...);
      (store_lanes(p[k] + i, kept[k], lanes), ...);
      store_lanes(out + i, next, lanes);
    });
  }

  T initial_;
  std::array<Vector<T>, kKept> kept_;
  long steps_ = 0;
};

}  // namespace physinv
