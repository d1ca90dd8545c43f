#include "problems/exponential/exponential.h"

#include <cmath>

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"

namespace physinv {
namespace {

enum Slot : std::size_t { kExponential };

template <class T>
void exponentials(BatchIn<T> x, BatchOut<T> y) {
  check_size(x, 1, x.cols());
  check_size(y, 1, x.cols());
  for (Index i = 0; i < x.cols(); ++i) y(0, i) = math::exp(x(0, i));
}

}  // namespace

template <class T>
Exponential<T>::Exponential(const Options& options) : options_(options) {
  check_numbers<T>({{"lowest", options.lowest}});
  SUITE_CHECK(options.lowest < 0, "lowest must be negative");
}

template <class T>
Samples<double> Exponential<T>::sample(Index first,
                                       Index count,
                                       const Rng& rng) const {
  Samples<double> out;
  out.x.resize(1, count), out.y.resize(1, count), out.given.resize(0, count);
  for (Index i = 0; i < count; ++i) {
    Stream stream = rng.child(static_cast<std::uint64_t>(first + i)).stream();
    out.x(0, i) = options_.lowest * stream.uniform(0, 1);
  }
  exponentials<double>(out.x, out.y);
  return out;
}

template <class T>
void Exponential<T>::forward(BatchIn<T> x,
                             BatchIn<T> /*given*/,
                             BatchOut<T> y,
                             Workspace& /*work*/) const {
  exponentials<T>(x, y);
}

template <class T>
void Exponential<T>::linearize(BatchIn<T> x,
                               BatchIn<T> /*given*/,
                               BatchOut<T> y,
                               Tape& tape) const {
  auto kept = tape.slot<T>(kExponential, 1, x.cols());
  exponentials<T>(x, y);
  kept = y;
}

template <class T>
void Exponential<T>::pullback(const Tape& tape,
                              BatchIn<T> y_bar,
                              BatchOut<T> x_bar,
                              Workspace& /*work*/) const {
  const auto kept = tape.view<T>(kExponential);
  check_size(y_bar, 1, kept.cols());
  check_size(x_bar, 1, kept.cols());
  for (Index i = 0; i < kept.cols(); ++i)
    x_bar(0, i) = kept(0, i) * y_bar(0, i);
}

template <class T>
void Exponential<T>::pushforward(const Tape& tape,
                                 BatchIn<T> x_dot,
                                 BatchOut<T> y_dot,
                                 Workspace& work) const {
  pullback(tape, x_dot, y_dot, work);
}

template <class T>
void Exponential<T>::pullback_tangent(const Tape& tape,
                                      BatchIn<T> x_dot,
                                      BatchIn<T> y_bar,
                                      BatchIn<T> y_bar_dot,
                                      BatchOut<T> x_bar_dot,
                                      Workspace& /*work*/) const {
  const auto kept = tape.view<T>(kExponential);
  check_size(y_bar_dot, 1, kept.cols());
  check_size(x_bar_dot, 1, kept.cols());
  for (Index i = 0; i < kept.cols(); ++i)
    x_bar_dot(0, i) =
        kept(0, i) * std::fma(x_dot(0, i), y_bar(0, i), y_bar_dot(0, i));
}

template <class T>
void Exponential<T>::jacobian(BatchIn<T> x,
                              BatchIn<T> /*given*/,
                              BatchOut<T> j,
                              Workspace& /*work*/) const {
  exponentials<T>(x, j);
}

template <class T>
void Exponential<T>::hessian(BatchIn<T> x,
                             BatchIn<T> /*given*/,
                             BatchIn<T> target,
                             BatchOut<T> h,
                             Workspace& /*work*/) const {
  check_size(target, 1, x.cols());
  exponentials<T>(x, h);
  for (Index i = 0; i < x.cols(); ++i) h(0, i) *= 2 * h(0, i) - target(0, i);
}

template <class T>
void Exponential<T>::invert(BatchIn<T> y,
                            BatchIn<T> /*given*/,
                            BatchIn<T> x_guess,
                            BatchOut<T> x,
                            Workspace& /*work*/) const {
  check_size(y, 1, x.cols());
  check_size(x_guess, 1, x.cols());
  check_size(x, 1, x.cols());
  for (Index i = 0; i < y.cols(); ++i) {
    const T guess = x_guess(0, i);
    x(0, i) = math::exp(guess) == y(0, i) ? guess : math::log(y(0, i));
  }
}

template class Exponential<float>;
template class Exponential<double>;

}  // namespace physinv
