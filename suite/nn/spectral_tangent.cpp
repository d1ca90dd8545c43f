#include <algorithm>

#include "suite/nn/activation.h"
#include "suite/nn/spectral.h"

namespace physinv::nn {
namespace {

/// f'(x) x_dot in `to`.
template <class T>
void push_activation(Activation f,
                     Lanes<const T> x,
                     Lanes<const T> x_dot,
                     Lanes<T> to) {
  std::copy_n(x_dot.data, x_dot.rows * x_dot.stride, to.data);
  apply_gate<T>({f, x}, to);
}

template <class T>
Lanes<T> like(Lanes<const T> x, Workspace& work) {
  Lanes<T> more(nullptr, x.rows, x.samples);
  more.data = work.take<T>(more.stride, more.rows).data();
  return more;
}

}  // namespace

/// (S + W) f'(x) x_dot, whose modes stay, + (S + W)_dot f(x) + b_dot.
template <class T>
void SpectralBlock<T>::tangent(const LayerArgs<T>& at,
                               const Tangent<T>& t) const {
  Workspace& work = *at.work;
  const Workspace::Scope scope(work);
  const Lanes<T> f_dot = like(t.x_dot, work);
  push_activation<T>(o_.before, t.x, t.x_dot, f_dot);
  apply({.parameters = at.parameters,
         .modes = open_modes(t.x, *at.dots, at.slot)},
        f_dot,
        t.y_dot,
        work);
  const Lanes<T> more = like(Lanes<const T>(t.y_dot), work);
  apply(
      {.parameters = at.parameters_dot,
       .bias = bias(at.parameters_dot),
       .f = o_.before,
       .modes = work.take<T>(2 * o_.channels * t.x.width, mode_count()).data()},
      t.x,
      more,
      work);
  add_lanes<T>(more, t.y_dot);
}

/// `pull` is bilinear in (weights, f(x)) and y_bar; b's part in y_bar alone.
template <class T>
void SpectralBlock<T>::backward_tangent(const LayerArgs<T>& at,
                                        const BackwardTangent<T>& b) const {
  Workspace& work = *at.work;
  const Workspace::Scope scope(work);
  const Product here{.parameters = at.parameters,
                     .f = o_.before,
                     .modes = at.tape->template view<T>(at.slot).data()};
  pull(here, b.base(), work);
  pull(here,
       {.x = b.x,
        .y = b.y,
        .y_bar = b.y_bar_dot,
        .parameters_bar = b.parameters_bar_dot,
        .x_bar = b.x_bar_dot},
       work);
  const Lanes<T> f_dot = like(b.x_dot, work);
  push_activation<T>(o_.before, b.x, b.x_dot, f_dot);
  const Index weights = 4 * spectral_size() + o_.channels * o_.channels;
  T* const sum = work.take<T>(weights + o_.channels, 1).data();
  Lanes<T> more;
  if (b.x_bar) more = like(Lanes<const T>(b.x_bar), work);
  pull({.parameters = at.parameters_dot,
        .modes = at.dots->template view<T>(at.slot).data()},
       {.x = f_dot,
        .y = b.y,
        .y_bar = b.y_bar,
        .parameters_bar = sum,
        .x_bar = more},
       work);
  for (Index i = 0; i < weights; ++i) b.parameters_bar_dot[i] += sum[i];
  if (!b.x_bar) return;
  add_lanes<T>(more, b.x_bar_dot);
  apply_gate_tangent<T>({o_.before, b.x}, b.x_dot, b.x_bar, b.x_bar_dot);
}

#define PHYSINV_INSTANTIATE(T)                                      \
  template void SpectralBlock<T>::tangent(const LayerArgs<T>&,      \
                                          const Tangent<T>&) const; \
  template void SpectralBlock<T>::backward_tangent(                 \
      const LayerArgs<T>&, const BackwardTangent<T>&) const;
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
