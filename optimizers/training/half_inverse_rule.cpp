#include "optimizers/training/half_inverse_rule.h"

#include "optimizers/metrics.h"

namespace physinv {

template <class T>
bool HalfInverseRule<T>::operator()(Signal<T>& signal) {
  const Jacobians<T> of = signal.jacobians();
  const bool taken = step_(model_.network(),
                           model_.parameters(),
                           model_.tape(),
                           of.solver,
                           of.g,
                           model_.workspace());
  const auto& report = step_.report();
  kept_.push_back(static_cast<double>(report.kept));
  smallest_.push_back(report.s_max > 0 ? report.smallest_kept / report.s_max
                                       : 0);
  path_.push_back(static_cast<double>(report.path));
  unproven_ += !report.proven;
  return taken;
}

template <class T>
void HalfInverseRule<T>::export_to(Outcome& out) const {
  out.arrays["kept"] = as_row(kept_);
  out.arrays["smallest"] = as_row(smallest_);
  out.arrays["path"] = as_row(path_);
  out.arrays["unproven"] = Batch<double>::Constant(1, 1, unproven_);
}

template class HalfInverseRule<float>;
template class HalfInverseRule<double>;

}  // namespace physinv
