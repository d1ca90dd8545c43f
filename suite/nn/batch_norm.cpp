#include "suite/nn/batch_norm.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "suite/core/check.h"
#include "suite/nn/activation.h"

namespace physinv::nn {
namespace {

constexpr double kEps = 1e-5, kMomentum = 0.1;

/// Columns of the tape slot, one number per feature each.
enum Column { kMean, kInverse, kUnbiased, kColumns };

/// Two or three samples leave one dimension of the cotangent or none: what
/// remains is a difference of nearly equal numbers. Hence double throughout.
template <std::size_t N>
using Terms = std::array<double, N>;

/// Sums of the terms of n samples. Lane l adds samples l, l + 8, ...; the
/// lanes are then added in order, so the order is that of n alone.
template <std::size_t N, class F>
Terms<N> sum(Index n, F&& term) {
  constexpr Index kWidth = 8;
  double lanes[N][kWidth] = {};
  Index j = 0;
  for (; j + kWidth <= n; j += kWidth)
    for (Index l = 0; l < kWidth; ++l) {
      const Terms<N> t = term(j + l);
      for (std::size_t k = 0; k < N; ++k) lanes[k][l] += t[k];
    }
  for (Index l = 0; j + l < n; ++l) {
    const Terms<N> t = term(j + l);
    for (std::size_t k = 0; k < N; ++k) lanes[k][l] += t[k];
  }
  Terms<N> total{};
  for (std::size_t k = 0; k < N; ++k)
    for (const double lane : lanes[k]) total[k] += lane;
  return total;
}

}  // namespace

template <class T>
std::vector<TensorInfo> BatchNorm<T>::tensors() const {
  const Index n = this->inputs();
  return {{.name = {}, .kind = 's', .offset = 0, .size = n, .fan_in = n},
          {.name = {}, .kind = 'o', .offset = 0, .size = n, .fan_in = n}};
}

template <class T>
void BatchNorm<T>::initialize_state(T* state) const {
  const Index n = this->inputs();
  for (Index i = 0; i < n; ++i) state[i] = T(0), state[n + i] = T(1);
}

template <class T>
void BatchNorm<T>::forward(const LayerArgs<T>& at,
                           Lanes<const T> x,
                           Lanes<T> y) const {
  SUITE_CHECK(!at.training || x.samples >= 2,
              "batch statistics need two samples");
  const Index features = this->inputs();
  auto kept = at.tape->template slot<double>(at.slot, features, kColumns);
  const T* scale = at.parameters;
  const T* offset = at.parameters + features;
  for (Index i = 0; i < features; ++i) {
    const T* row = x.row(i);
    double mean = 0, variance = 0;
    if (at.training) {
      const auto n = static_cast<double>(x.samples);
      mean = sum<1>(x.samples,
                    [&](Index j) { return Terms<1>{double(row[j])}; })[0] /
             n;
      variance = sum<1>(x.samples, [&](Index j) {
        const double d = double(row[j]) - mean;
        return Terms<1>{d * d};
      })[0];
      kept(i, kUnbiased) = variance / (n - 1);
      variance /= n;
    } else {
      mean = double(at.state[i]), variance = double(at.state[features + i]);
    }
    const double inverse = 1.0 / std::sqrt(variance + kEps);
    kept(i, kMean) = mean, kept(i, kInverse) = inverse;
    const auto s = double(scale[i]), o = double(offset[i]);
    T* to = y.row(i);
    for (Index j = 0; j < x.width; ++j)
      to[j] = static_cast<T>(std::fma(s, (double(row[j]) - mean) * inverse, o));
  }
}

template <class T>
void BatchNorm<T>::backward(const LayerArgs<T>& at,
                            const Backward<T>& b) const {
  const Index features = this->inputs(), n = b.x.samples;
  const auto kept = at.tape->template view<double>(at.slot);
  for (Index i = 0; i < features; ++i) {
    const double m = kept(i, kMean), inverse = kept(i, kInverse);
    const T *x = b.x.row(i), *y_bar = b.y_bar.row(i);
    const auto [total, product] = sum<2>(n, [&](Index j) {
      const auto g = double(y_bar[j]);
      return Terms<2>{g, g * ((double(x[j]) - m) * inverse)};
    });
    if (b.parameters_bar != nullptr) {
      b.parameters_bar[i] = static_cast<T>(product);
      b.parameters_bar[features + i] = static_cast<T>(total);
    }
    if (!b.x_bar) continue;
    T* x_bar = b.x_bar.row(i);
    const double factor = double(at.parameters[i]) * inverse;
    // Outside training the statistics are constants.
    const double s = at.training ? total / double(n) : 0;
    const double p = at.training ? product / double(n) : 0;
    for (Index j = 0; j < n; ++j)
      x_bar[j] = static_cast<T>(
          factor * (double(y_bar[j]) - s - (double(x[j]) - m) * inverse * p));
    for (Index j = n; j < b.x_bar.width; ++j) x_bar[j] = T(0);
  }
  if (b.x_bar) apply_gate(b.gate, b.x_bar);
}

template <class T>
void BatchNorm<T>::update_state(const Tape& tape,
                                std::size_t slot,
                                T* state) const {
  const Index features = this->inputs();
  const auto kept = tape.view<double>(slot);
  const auto move = [](T& to, double from) {
    to = static_cast<T>((1 - kMomentum) * double(to) + kMomentum * from);
  };
  for (Index i = 0; i < features; ++i) {
    move(state[i], kept(i, kMean));
    move(state[features + i], kept(i, kUnbiased));
  }
}

template class BatchNorm<float>;
template class BatchNorm<double>;

}  // namespace physinv::nn
