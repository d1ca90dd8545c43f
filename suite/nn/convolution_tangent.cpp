#include "suite/nn/convolution_tangent.h"

namespace physinv::nn {

template <class T>
void pull_convolution(const Convolution<T>& conv,
                      const Replay<T>& at,
                      const BackwardTangent<T>& b,
                      Rows<const T> y_bar,
                      Rows<const T> y_bar_dot) {
  const auto nothing = [](Index, Index) {};
  conv.gradients(at, b.x, y_bar, 1, b.parameters_bar, b.x_bar, nothing);
  conv.gradients(
      at, b.x, y_bar_dot, 1, b.parameters_bar_dot, b.x_bar_dot, nothing);
  const Workspace::Scope scope(*at.work);
  Replay<T> cross = at;
  cross.parameters = b.parameters_dot;
  auto sum = at.work->template take<T>(conv.shape().weights(), 1);
  Rows<T> more;
  if (b.x_bar) more = take_rows<T>(*at.work, b.x_bar.rows, b.x.samples);
  conv.gradients(cross, b.x_dot, y_bar, 1, sum.data(), more, nothing);
  for (Index i = 0; i < sum.size(); ++i) b.parameters_bar_dot[i] += sum(i);
  if (b.x_bar) add_to_rows<T>(more, b.x_bar_dot);
}

#define PHYSINV_INSTANTIATE(T) \
  template decltype(pull_convolution<T>) pull_convolution<T>;
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
