#include "problems/robotic_arm/robotic_arm.h"

#include <algorithm>
#include <cmath>

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"

namespace physinv {
namespace {

constexpr Index kTurns = 6;  // d_1, d_2, d_3 of one sample
enum Slot : std::size_t { kDerivatives };

template <class T>
constexpr int kArms = math::kTogether<T>;  ///< that bend together

/// Tips of some arms, and d[2 k], d[2 k + 1] = d_k.
template <class T>
void reach(const T (&links)[3],
           const T (&x)[4][kArms<T>],
           T (&y)[2][kArms<T>],
           T (&d)[kTurns][kArms<T>]) {
  for (int i = 0; i < kArms<T>; ++i) y[0][i] = 0, y[1][i] = x[0][i];
  for (int k = 0; k < 3; ++k) {
    T phi[kArms<T>], sine[kArms<T>], cosine[kArms<T>];
    for (int i = 0; i < kArms<T>; ++i)
      phi[i] = k == 0   ? x[1][i]
               : k == 1 ? x[2][i] - x[1][i]
                        : x[3][i] - x[2][i] - x[1][i];
    math::sincos(phi, sine, cosine);
    for (int i = 0; i < kArms<T>; ++i) {
      const T across = links[k] * cosine[i], up = links[k] * sine[i];
      y[0][i] += across, y[1][i] += up;
      d[2 * k][i] = -up, d[2 * k + 1][i] = across;
    }
  }
}

/// Runs body(i, tip, derivatives) for every column of x.
template <class T, class F>
void for_arms(const RoboticArmOptions& options, BatchIn<T> x, F&& body) {
  const T links[3] = {
      T(options.links[0]), T(options.links[1]), T(options.links[2])};
  constexpr Index kWidth = kArms<T>;
  for (Index first = 0; first < x.cols(); first += kWidth) {
    T in[4][kWidth], y[2][kWidth], d[kTurns][kWidth];
    const Index count = std::min(kWidth, x.cols() - first);
    for (Index i = 0; i < kWidth; ++i)
      for (Index j = 0; j < 4; ++j)
        in[j][i] = x(j, first + std::min(i, count - 1));
    reach<T>(links, in, y, d);
    for (Index i = 0; i < count; ++i) {
      const T tip[2] = {y[0][i], y[1][i]};
      T turns[kTurns];
      for (Index k = 0; k < kTurns; ++k) turns[k] = d[k][i];
      body(first + i, tip, turns);
    }
  }
}

}  // namespace

std::array<std::array<double, 2>, 4> arm_joints(const std::array<double, 4>& x,
                                                const RoboticArmOptions& o) {
  const double links[3] = {o.links[0], o.links[1], o.links[2]};
  double in[4][kArms<double>], y[2][kArms<double>], d[kTurns][kArms<double>];
  for (std::size_t j = 0; j < 4; ++j) std::fill_n(in[j], kArms<double>, x[j]);
  reach<double>(links, in, y, d);
  std::array<std::array<double, 2>, 4> at{};
  at[0] = {0, x[0]};
  for (std::size_t k = 0; k < 3; ++k)
    at[k + 1] = {at[k][0] + d[2 * k + 1][0], at[k][1] - d[2 * k][0]};
  return at;
}

template <class T>
RoboticArm<T>::RoboticArm(const Options& options) : options_(options) {
  for (const double l : options.links) {
    check_numbers<T>({{"links", l}});
    SUITE_CHECK(l > 0, "links must have a length");
  }
  for (const double m : options.mean) check_numbers<T>({{"mean", m}});
  for (const double s : options.deviation) check_numbers<T>({{"deviation", s}});
  for (const double s : options.deviation)
    SUITE_CHECK(s >= 0, "deviations must not be negative");
}

template <class T>
Vector<double> RoboticArm<T>::start() const {
  return Eigen::Map<const Eigen::Vector4d>(options_.mean.data());
}

template <class T>
Samples<double> RoboticArm<T>::sample(Index first,
                                      Index count,
                                      const Rng& rng) const {
  Samples<double> out;
  out.x.resize(4, count), out.y.resize(2, count), out.given.resize(0, count);
  for (Index i = 0; i < count; ++i) {
    Stream stream = rng.child(static_cast<std::uint64_t>(first + i)).stream();
    for (std::size_t j = 0; j < 4; ++j)
      out.x(static_cast<Index>(j), i) =
          options_.mean[j] + options_.deviation[j] * stream.normal();
  }
  Workspace work;
  RoboticArm<double>(options_).forward(out.x, out.given, out.y, work);
  return out;
}

template <class T>
void RoboticArm<T>::forward(BatchIn<T> x,
                            BatchIn<T> /*given*/,
                            BatchOut<T> y,
                            Workspace& /*work*/) const {
  check_size(x, 4, x.cols());
  check_size(y, 2, x.cols());
  for_arms<T>(options_, x, [&](Index i, const T* tip, const T*) {
    y(0, i) = tip[0], y(1, i) = tip[1];
  });
}

template <class T>
void RoboticArm<T>::linearize(BatchIn<T> x,
                              BatchIn<T> /*given*/,
                              BatchOut<T> y,
                              Tape& tape) const {
  check_size(x, 4, x.cols());
  check_size(y, 2, x.cols());
  auto kept = tape.slot<T>(kDerivatives, kTurns, x.cols());
  for_arms<T>(options_, x, [&](Index i, const T* tip, const T* d) {
    y(0, i) = tip[0], y(1, i) = tip[1];
    for (Index k = 0; k < kTurns; ++k) kept(k, i) = d[k];
  });
}

template <class T>
void RoboticArm<T>::pullback(const Tape& tape,
                             BatchIn<T> y_bar,
                             BatchOut<T> x_bar,
                             Workspace& /*work*/) const {
  const auto kept = tape.view<T>(kDerivatives);
  check_size(y_bar, 2, kept.cols());
  check_size(x_bar, 4, kept.cols());
  for (Index i = 0; i < kept.cols(); ++i) {
    const T r0 = y_bar(0, i), r1 = y_bar(1, i);
    T t[3];
    for (Index k = 0; k < 3; ++k)
      t[k] = std::fma(kept(2 * k, i), r0, kept(2 * k + 1, i) * r1);
    x_bar(0, i) = r1;
    x_bar(1, i) = t[0] - t[1] - t[2];
    x_bar(2, i) = t[1] - t[2];
    x_bar(3, i) = t[2];
  }
}

template <class T>
void RoboticArm<T>::jacobian(BatchIn<T> x,
                             BatchIn<T> /*given*/,
                             BatchOut<T> j,
                             Workspace& /*work*/) const {
  check_size(x, 4, x.cols());
  check_size(j, 8, x.cols());
  for_arms<T>(options_, x, [&](Index i, const T*, const T* d) {
    for (Index r = 0; r < 2; ++r) {
      j(r, i) = T(r);
      j(2 + r, i) = d[r] - d[2 + r] - d[4 + r];
      j(4 + r, i) = d[2 + r] - d[4 + r];
      j(6 + r, i) = d[4 + r];
    }
  });
}

template class RoboticArm<float>;
template class RoboticArm<double>;

}  // namespace physinv
