#include "problems/scaled_output/scaled_output.h"

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"

namespace physinv {
namespace {

/// out <- f(i, x_1, x_2) of every column, from plain pointers: columns are too
/// short for Eigen's.
template <class T, class F>
void for_columns(BatchIn<T> in, BatchOut<T>& out, F f) {
  const Index from = in.outerStride(), to = out.outerStride();
  const T* const x = in.data();
  T* const y = out.data();
  for (Index i = 0; i < in.cols(); ++i)
    f(i, x[from * i], x[from * i + 1], y + to * i);
}

template <class T>
void scale(T gamma, BatchIn<T> in, BatchOut<T>& out) {
  for_columns<T>(
      in, out, [=](Index, T a, T b, T* y) { y[0] = a, y[1] = gamma * b; });
}

/// 0, or NaN at a point that is not finite: the map is linear, but its
/// derivatives must say where they were asked for.
template <class T>
T poison(T a, T b) {
  return T(0) * a + T(0) * b;
}

enum Slot : std::size_t { kPoison };

}  // namespace

template <class T>
ScaledOutput<T>::ScaledOutput(const Options& options) : options_(options) {
  check_numbers<T>({{"gamma", options.gamma}});
  SUITE_CHECK(options.gamma > 0, "gamma must be positive");
}

template <class T>
Samples<double> ScaledOutput<T>::sample(Index first,
                                        Index count,
                                        const Rng& rng) const {
  Samples<double> out;
  out.x.resize(2, count), out.y.resize(2, count), out.given.resize(1, count);
  for (Index i = 0; i < count; ++i) {
    Stream stream = rng.child(static_cast<std::uint64_t>(first + i)).stream();
    const double t = stream.uniform(-1, 1);
    out.given(0, i) = t;
    out.y.col(i) << math::sin(6 * t), math::cos(9 * t);
    out.x.col(i) << out.y(0, i), out.y(1, i) / options_.gamma;
  }
  return out;
}

template <class T>
Samples<double> ScaledOutput<T>::sample_labelled(Index first,
                                                 Index count,
                                                 const Rng& rng) const {
  Samples<double> out = sample(first, count, rng);
  Workspace work;
  ScaledOutput<double>(options_).forward(out.x, out.given, out.y, work);
  return out;
}

template <class T>
void ScaledOutput<T>::forward(BatchIn<T> x,
                              BatchIn<T> /*given*/,
                              BatchOut<T> y,
                              Workspace& /*work*/) const {
  check_size(x, 2, x.cols());
  check_size(y, 2, x.cols());
  scale<T>(T(options_.gamma), x, y);
}

template <class T>
void ScaledOutput<T>::linearize(BatchIn<T> x,
                                BatchIn<T> /*given*/,
                                BatchOut<T> y,
                                Tape& tape) const {
  check_size(x, 2, x.cols());
  check_size(y, 2, x.cols());
  auto kept = tape.slot<T>(kPoison, 1, x.cols());
  for_columns<T>(x,
                 y,
                 [gamma = T(options_.gamma), zero = kept.data()](
                     Index i, T a, T b, T* out) {
                   zero[i] = poison(a, b);
                   out[0] = a, out[1] = gamma * b;
                 });
}

template <class T>
void ScaledOutput<T>::pullback(const Tape& tape,
                               BatchIn<T> y_bar,
                               BatchOut<T> x_bar,
                               Workspace& /*work*/) const {
  const auto kept = tape.view<T>(kPoison);
  check_size(y_bar, 2, kept.cols());
  check_size(x_bar, 2, kept.cols());
  for_columns<T>(y_bar,
                 x_bar,
                 [gamma = T(options_.gamma), zero = kept.data()](
                     Index i, T a, T b, T* out) {
                   out[0] = a + zero[i], out[1] = gamma * b + zero[i];
                 });
}

template <class T>
void ScaledOutput<T>::jacobian(BatchIn<T> x,
                               BatchIn<T> /*given*/,
                               BatchOut<T> j,
                               Workspace& /*work*/) const {
  check_size(x, 2, x.cols());
  check_size(j, 4, x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    const T zero = poison(x(0, i), x(1, i));
    j.col(i) << T(1) + zero, zero, zero, T(options_.gamma) + zero;
  }
}

template class ScaledOutput<float>;
template class ScaledOutput<double>;

}  // namespace physinv
