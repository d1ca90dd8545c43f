#include "problems/scaled_output/scaled_output.h"

#include <fmt/format.h>

#include <cmath>

#include "suite/core/check.h"

namespace physinv {
namespace {

template <class T>
void scale(T gamma, BatchIn<T> in, BatchOut<T>& out) {
  for (Index i = 0; i < in.cols(); ++i) {
    out(0, i) = in(0, i);
    out(1, i) = gamma * in(1, i);
  }
}

/// 0, or NaN at a point that is not finite: the map is linear, but its
/// derivatives must say where they were asked for.
template <class T>
T poison(const T* x) {
  return T(0) * x[0] + T(0) * x[1];
}

enum Slot : std::size_t { kPoison };

}  // namespace

Options describe(const ScaledOutputOptions& o) {
  return {{"gamma", fmt::format("{}", o.gamma)}};
}

template <class T>
ScaledOutput<T>::ScaledOutput(const Options& options) : options_(options) {
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
    out.y.col(i) << std::sin(6 * t), std::cos(9 * t);
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
  for (Index i = 0; i < x.cols(); ++i) kept(0, i) = poison(x.col(i).data());
  scale<T>(T(options_.gamma), x, y);
}

template <class T>
void ScaledOutput<T>::pullback(const Tape& tape,
                               BatchIn<T> y_bar,
                               BatchOut<T> x_bar,
                               Workspace& /*work*/) const {
  const auto kept = tape.view<T>(kPoison);
  check_size(y_bar, 2, kept.cols());
  check_size(x_bar, 2, kept.cols());
  scale<T>(T(options_.gamma), y_bar, x_bar);
  x_bar.rowwise() += kept.row(0);
}

template <class T>
void ScaledOutput<T>::jacobian(BatchIn<T> x,
                               BatchIn<T> /*given*/,
                               BatchOut<T> j,
                               Workspace& /*work*/) const {
  check_size(x, 2, x.cols());
  check_size(j, 4, x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    const T zero = poison(x.col(i).data());
    j.col(i) << T(1) + zero, zero, zero, T(options_.gamma) + zero;
  }
}

template class ScaledOutput<float>;
template class ScaledOutput<double>;

}  // namespace physinv
