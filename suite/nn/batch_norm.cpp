#include "suite/nn/batch_norm.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "suite/core/check.h"
#include "suite/nn/activation.h"
#include "suite/nn/norm_constants.h"

namespace physinv::nn {
namespace {

/// Columns of the tape slot, one number per feature each.
enum Column { kMean, kInverse, kUnbiased, kColumns };
/// And of its derivative's: n being (x - mean) inverse, the means of x_dot and
/// of n x_dot; zero outside training.
enum DotColumn { kMeanDot, kSlope, kDotColumns };

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

template <class T>
class BatchNorm final : public Layer<T> {
 public:
  explicit BatchNorm(Index features) : Layer<T>(features, features) {}

  std::vector<TensorInfo> tensors() const override {
    const Index n = this->inputs();
    return {{.name = {}, .kind = 's', .offset = 0, .size = n, .fan_in = n},
            {.name = {}, .kind = 'o', .offset = 0, .size = n, .fan_in = n}};
  }
  Index state_count() const override { return 2 * this->inputs(); }
  void initialize_state(T* state) const override {
    const Index n = this->inputs();
    for (Index i = 0; i < n; ++i) state[i] = T(0), state[n + i] = T(1);
  }
  std::size_t slots() const override { return 1; }
  void forward(const Run<T>& at, Rows<const T> x, Rows<T> y) const override {
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
      const double inverse = 1.0 / std::sqrt(variance + kNormEps);
      kept(i, kMean) = mean, kept(i, kInverse) = inverse;
      const auto s = double(scale[i]), o = double(offset[i]);
      T* to = y.row(i);
      for (Index j = 0; j < x.width; ++j)
        to[j] =
            static_cast<T>(std::fma(s, (double(row[j]) - mean) * inverse, o));
    }
  }

  void backward(const Replay<T>& at, const Backward<T>& b) const override {
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

  void tangent(const Replay<T>& at, const Tangent<T>& t) const override {
    const Index features = this->inputs(), n = t.x.samples;
    const auto kept = at.tape->template view<double>(at.slot);
    auto dots = t.dots->template slot<double>(at.slot, features, kDotColumns);
    for (Index i = 0; i < features; ++i) {
      const double m = kept(i, kMean), inverse = kept(i, kInverse);
      const T *x = t.x.row(i), *x_dot = t.x_dot.row(i);
      const auto normal = [&](Index j) { return (double(x[j]) - m) * inverse; };
      Terms<2> means{};
      if (at.training)
        means = sum<2>(n, [&](Index j) {
          const auto d = double(x_dot[j]);
          return Terms<2>{d, d * normal(j)};
        });
      const double mean = means[0] / double(n), slope = means[1] / double(n);
      dots(i, kMeanDot) = mean, dots(i, kSlope) = slope;
      const auto scale = double(at.parameters[i]);
      const auto scale_dot = double(t.parameters_dot[i]);
      const auto offset_dot = double(t.parameters_dot[features + i]);
      for (Index j = 0; j < t.y_dot.width; ++j) {
        const double normal_dot =
            inverse * (double(x_dot[j]) - mean - normal(j) * slope);
        t.y_dot.row(i)[j] = static_cast<T>(scale * normal_dot +
                                           scale_dot * normal(j) + offset_dot);
      }
    }
  }

  /// The derivative of `backward`, term by term; inverse' = -inverse^2 slope.
  void backward_tangent(const Replay<T>& at,
                        const BackwardTangent<T>& b) const override {
    backward(at, b.base());
    const Index features = this->inputs(), n = b.x.samples;
    const auto kept = at.tape->template view<double>(at.slot);
    const auto dots = b.dots->template view<double>(at.slot);
    for (Index i = 0; i < features; ++i) {
      const double m = kept(i, kMean), inverse = kept(i, kInverse);
      const double mean = dots(i, kMeanDot), slope = dots(i, kSlope);
      const T *x = b.x.row(i), *x_dot = b.x_dot.row(i);
      const T *y_bar = b.y_bar.row(i), *y_bar_dot = b.y_bar_dot.row(i);
      const auto normal = [&](Index j) { return (double(x[j]) - m) * inverse; };
      const auto normal_dot = [&](Index j) {
        return inverse * (double(x_dot[j]) - mean - normal(j) * slope);
      };
      const auto sums = sum<4>(n, [&](Index j) {
        const auto g = double(y_bar[j]), g_dot = double(y_bar_dot[j]);
        return Terms<4>{
            g, g * normal(j), g_dot, g_dot * normal(j) + g * normal_dot(j)};
      });
      b.parameters_bar_dot[i] = static_cast<T>(sums[3]);
      b.parameters_bar_dot[features + i] = static_cast<T>(sums[2]);
      if (!b.x_bar) continue;
      const double share = at.training ? 1 / double(n) : 0;
      const double s = sums[0] * share, p = sums[1] * share,
                   s_dot = sums[2] * share, p_dot = sums[3] * share;
      const auto scale = double(at.parameters[i]);
      const double factor = scale * inverse;
      const double factor_dot =
          inverse * (double(b.parameters_dot[i]) - scale * inverse * slope);
      T* to = b.x_bar_dot.row(i);
      for (Index j = 0; j < n; ++j)
        to[j] =
            static_cast<T>(factor_dot * (double(y_bar[j]) - s - normal(j) * p) +
                           factor * (double(y_bar_dot[j]) - s_dot -
                                     normal_dot(j) * p - normal(j) * p_dot));
      for (Index j = n; j < b.x_bar.width; ++j) to[j] = T(0);
    }
  }

  void update_state(const Tape& tape,
                    std::size_t slot,
                    T* state) const override {
    const Index features = this->inputs();
    const auto kept = tape.view<double>(slot);
    const auto move = [](T& to, double from) {
      to = static_cast<T>((1 - kNormMomentum) * double(to) +
                          kNormMomentum * from);
    };
    for (Index i = 0; i < features; ++i) {
      move(state[i], kept(i, kMean));
      move(state[features + i], kept(i, kUnbiased));
    }
  }
  double operations() const override {
    return 8.0 * static_cast<double>(this->inputs());
  }
};

}  // namespace

template <class T>
LayerPointer<T> batch_norm(Index features) {
  return std::make_unique<BatchNorm<T>>(features);
}

template decltype(batch_norm<float>) batch_norm<float>;
template decltype(batch_norm<double>) batch_norm<double>;

}  // namespace physinv::nn
