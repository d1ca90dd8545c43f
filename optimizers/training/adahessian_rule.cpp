#include "optimizers/training/adahessian_rule.h"

#include "suite/core/simd/finite.h"

namespace physinv {

template <class T>
bool AdaHessianRule<T>::operator()(Signal<T>& signal) {
  Vector<T>& parameters = model_.parameters();
  // A product takes the gradient's memory.
  next_ = signal.gradient();
  probe_.resize(parameters.size());
  Stream stream = probes_.child(updates_++).stream();
  std::uint64_t bits = 0;
  for (Index i = 0; i < probe_.size(); ++i, bits >>= 1) {
    if (i % 64 == 0) bits = stream.bits();
    probe_(i) = (bits & 1) != 0 ? T(1) : T(-1);
  }
  signal.hessian_product(probe_, curvature_);
  step_.step(parameters, next_, curvature_, next_);
  if (!all_finite(next_.data(), next_.size())) return false;
  parameters.swap(next_);
  return true;
}

template <class T>
std::size_t AdaHessianRule<T>::bytes() const {
  return static_cast<std::size_t>((3 + AdaHessian<T>::kNumbersPerParameter) *
                                  model_.parameters().size()) *
         sizeof(T);
}

template class AdaHessianRule<float>;
template class AdaHessianRule<double>;

}  // namespace physinv
