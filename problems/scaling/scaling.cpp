#include "problems/scaling/scaling.h"

#include <cmath>

#include "suite/core/check.h"
#include "suite/core/option_check.h"

namespace physinv {
namespace {

enum Slot : std::size_t { kSlopes };

}  // namespace

template <class T>
Scaling<T>::Scaling(const Options& options) : options_(options) {
  SUITE_CHECK(options.power == 1 || options.power == 2, "power must be 1 or 2");
  check_numbers<T>("scales", options.scales);
  for (const double alpha : options.scales)
    SUITE_CHECK(alpha != 0, "a scale must not be 0");
  check_numbers<T>({{"start", options.start[0]}, {"start", options.start[1]}});
}

template <class T>
Vector<double> Scaling<T>::start() const {
  return Eigen::Vector2d(options_.start[0], options_.start[1]);
}

template <class T>
Samples<double> Scaling<T>::draw(Index first,
                                 Index count,
                                 const Rng& rng,
                                 bool labelled) const {
  Samples<double> out;
  out.x.setZero(2, count), out.y.setZero(2, count), out.given.resize(1, count);
  const auto listed = static_cast<Index>(options_.scales.size());
  for (Index i = 0; i < count; ++i) {
    const Index k = first + i;
    Stream stream = rng.child(static_cast<std::uint64_t>(k)).stream();
    const double drawn = stream.uniform(1, 5);
    out.given(0, i) =
        k < listed ? options_.scales[static_cast<std::size_t>(k)] : drawn;
    if (!labelled) continue;
    for (Index j = 0; j < 2; ++j) out.x(j, i) = stream.uniform(0.5, 3.5);
  }
  return out;
}

template <class T>
Samples<double> Scaling<T>::sample(Index first,
                                   Index count,
                                   const Rng& rng) const {
  return draw(first, count, rng, false);
}

template <class T>
Samples<double> Scaling<T>::sample_labelled(Index first,
                                            Index count,
                                            const Rng& rng) const {
  Samples<double> out = draw(first, count, rng, true);
  Workspace work;
  Scaling<double>(options_).forward(out.x, out.given, out.y, work);
  return out;
}

template <class T>
typename Scaling<T>::Point Scaling<T>::at(BatchIn<T> x,
                                          BatchIn<T> given,
                                          Index i) const {
  const T a = x(0, i), b = x(1, i), alpha = given(0, i);
  const T zero = (a - a) + (b - b);  // NaN where x is not finite
  if (options_.power == 1)
    return {{a + zero, alpha * b + zero}, {1 + zero, alpha + zero}};
  return {{a + zero, alpha * (b * b) + zero}, {1 + zero, 2 * alpha * b + zero}};
}

template <class T>
void Scaling<T>::forward(BatchIn<T> x,
                         BatchIn<T> given,
                         BatchOut<T> y,
                         Workspace& /*work*/) const {
  check_size(x, 2, x.cols());
  check_size(given, 1, x.cols());
  check_size(y, 2, x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    const Point p = at(x, given, i);
    y.col(i) << p.y[0], p.y[1];
  }
}

template <class T>
void Scaling<T>::loss(BatchIn<T> y,
                      BatchIn<T> target,
                      VectorOut<double> loss) const {
  Problem<T>::loss(y, target, loss);
  loss *= static_cast<double>(scale());
}

template <class T>
void Scaling<T>::loss_gradient(BatchIn<T> y,
                               BatchIn<T> target,
                               BatchOut<T> y_bar) const {
  for_numbers<T>(
      y, target, y_bar, [c = scale()](T a, T b) { return c * (a - b); });
}

template <class T>
void Scaling<T>::linearize(BatchIn<T> x,
                           BatchIn<T> given,
                           BatchOut<T> y,
                           Tape& tape) const {
  check_size(x, 2, x.cols());
  check_size(given, 1, x.cols());
  check_size(y, 2, x.cols());
  auto slopes = tape.slot<T>(kSlopes, 2, x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    const Point p = at(x, given, i);
    y.col(i) << p.y[0], p.y[1];
    slopes.col(i) << p.slope[0], p.slope[1];
  }
}

template <class T>
void Scaling<T>::pullback(const Tape& tape,
                          BatchIn<T> y_bar,
                          BatchOut<T> x_bar,
                          Workspace& /*work*/) const {
  const auto slopes = tape.view<T>(kSlopes);
  check_size(y_bar, 2, slopes.cols());
  check_size(x_bar, 2, slopes.cols());
  for_numbers<T>(slopes, y_bar, x_bar, [](T a, T b) { return a * b; });
}

template <class T>
void Scaling<T>::jacobian(BatchIn<T> x,
                          BatchIn<T> given,
                          BatchOut<T> j,
                          Workspace& /*work*/) const {
  check_size(x, 2, x.cols());
  check_size(given, 1, x.cols());
  check_size(j, 4, x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    const Point p = at(x, given, i);
    j.col(i) << p.slope[0], 0, 0, p.slope[1];
  }
}

template <class T>
void Scaling<T>::hessian(BatchIn<T> x,
                         BatchIn<T> given,
                         BatchIn<T> target,
                         BatchOut<T> h,
                         Workspace& /*work*/) const {
  check_size(x, 2, x.cols());
  check_size(given, 1, x.cols());
  check_size(target, 2, x.cols());
  check_size(h, 4, x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    const Point p = at(x, given, i);
    const T bend = options_.power == 2 ? 2 * given(0, i) : T(0);
    const T second =
        std::fma(p.slope[1], p.slope[1], (p.y[1] - target(1, i)) * bend);
    h.col(i) << scale() * (p.slope[0] * p.slope[0]), 0, 0, scale() * second;
  }
}

template <class T>
void Scaling<T>::invert(BatchIn<T> y,
                        BatchIn<T> given,
                        BatchIn<T> x_guess,
                        BatchOut<T> x,
                        Workspace& /*work*/) const {
  check_size(y, 2, x.cols());
  check_size(given, 1, x.cols());
  check_size(x_guess, 2, x.cols());
  check_size(x, 2, x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    const T b = y(1, i) / given(0, i);
    const T root = b < 0 ? T(0) : std::sqrt(b);
    x.col(i) << y(0, i),
        options_.power == 2 ? std::copysign(root, x_guess(1, i)) : b;
  }
}

// Neither step divides by what may be a square that underflowed.

template <class T>
void Scaling<T>::newton_step(BatchIn<T> x,
                             BatchIn<T> given,
                             BatchIn<T> target,
                             BatchOut<T> dx) const {
  for (Index i = 0; i < x.cols(); ++i) {
    const Point p = at(x, given, i);
    const T b = x(1, i), goal = target(1, i), rest = goal - p.y[1];
    T step = rest / given(0, i);
    if (options_.power == 2)
      step = goal == 0 ? -b / 3 : b * (rest / std::fma(T(3), p.y[1], -goal));
    dx.col(i) << target(0, i) - p.y[0], step;
  }
}

template <class T>
void Scaling<T>::inverse_gradient_step(BatchIn<T> x,
                                       BatchIn<T> given,
                                       BatchIn<T> target,
                                       BatchOut<T> dx) const {
  for (Index i = 0; i < x.cols(); ++i) {
    const Point p = at(x, given, i);
    const T b = x(1, i), goal = target(1, i);
    T step = (goal - p.y[1]) / p.slope[1];
    if (options_.power == 2 && goal == 0) step = -b / 2;
    dx.col(i) << target(0, i) - p.y[0], step;
  }
}

template class Scaling<float>;
template class Scaling<double>;

}  // namespace physinv
