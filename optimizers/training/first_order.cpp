#include "optimizers/training/first_order.h"

#include "suite/core/simd/finite.h"

namespace physinv {

template <class T>
bool FirstOrder<T>::operator()(Signal<T>& signal) {
  const Vector<T>& gradient = signal.gradient();
  step_(model_.parameters(), gradient);
  return true;
}

template <class T>
std::size_t FirstOrder<T>::bytes() const {
  return static_cast<std::size_t>(step_.numbers_per_parameter() *
                                  model_.parameters().size()) *
         sizeof(T);
}

template <class T>
bool GuardedFirstOrder<T>::operator()(Signal<T>& signal) {
  // The gradient's memory takes the new parameters, so that the old ones are
  // there should these be spoilt.
  Vector<T>& next = signal.gradient();
  Vector<T>& parameters = this->model_.parameters();
  this->step_(parameters, next, next);
  if (!all_finite(next.data(), next.size())) return false;
  parameters.swap(next);
  return true;
}

template class FirstOrder<float>;
template class FirstOrder<double>;
template class GuardedFirstOrder<float>;
template class GuardedFirstOrder<double>;

}  // namespace physinv
