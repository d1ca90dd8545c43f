#include "suite/diagnostics/one_step.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/simd/math.h"
#include "suite/core/workspace.h"

namespace physinv {
namespace {

/// An array of packs that only grows.
template <class T>
class Packs {
 public:
  Pack<T>* take(Index count) {
    size_ = count;
    return static_cast<Pack<T>*>(
        buffer_.reserve(static_cast<std::size_t>(count) * sizeof(Pack<T>)));
  }
  Pack<T>* data() const { return static_cast<Pack<T>*>(buffer_.data()); }
  std::span<Pack<T>> span() const {
    return {data(), static_cast<std::size_t>(size_)};
  }
  Pack<T>& operator[](Index i) const { return data()[i]; }

 private:
  Buffer buffer_;
  Index size_ = 0;
};

template <class T>
PHYSINV_LANES Pack<T> all(T value) {
  return value - Pack<T>{};
}

template <class T>
PHYSINV_LANES Pack<T> relu(Pack<T> z) {
  return z > Pack<T>{} ? z : Pack<T>{};
}

// ---- one hidden layer of ReLU ----------------------------------------------

template <class T>
class HingeStep final : public OneStep<T> {
 public:
  using P = Pack<T>;

  explicit HingeStep(const TinyNetOptions& o)
      : units_(o.hidden.front()),
        scale_(static_cast<T>(o.scale)),
        // The step in the weights, times d x / d output.
        rate_(static_cast<T>(o.rate / o.scale)) {
    theta_.take(3 * units_ + 1);
    moved_.take(3 * units_ + 1);
  }

  std::span<P> parameters() override { return theta_.span(); }
  std::vector<Index> fan_in() const override {
    std::vector<Index> all(static_cast<std::size_t>(2 * units_), 1);
    all.resize(static_cast<std::size_t>(3 * units_ + 1), units_);
    return all;
  }
  Index passes(Index n) const override { return n; }

  void predict(const P* gamma, Index n, P* x) override {
    gamma_ = gamma, n_ = n;
    forward(theta_, x_.take(n));
    for (Index i = 0; i < n; ++i) x[i] = x_[i];
  }

  void respond(const P* g, P* delta) override {
    P sum{};
    for (Index i = 0; i < n_; ++i) sum += g[i];
    moved_[3 * units_] = theta_[3 * units_] - rate_ * sum;
    Index u = 0;
    for (; u + kTile <= units_; u += kTile) step<kTile>(u, g);
    for (; u < units_; ++u) step<1>(u, g);
    forward(moved_, delta);
    for (Index i = 0; i < n_; ++i) delta[i] -= x_[i];
  }

 private:
  static constexpr Index kTile = 4;

  /// w of the first layer, its biases, w of the second, its bias.
  void forward(const Packs<T>& theta, P* x) const {
    for (Index i = 0; i < n_; ++i) x[i] = theta[3 * units_];
    Index u = 0;
    for (; u + kTile <= units_; u += kTile) add_units<kTile>(theta, u, x);
    for (; u < units_; ++u) add_units<1>(theta, u, x);
    if (scale_ != T(1))
      for (Index i = 0; i < n_; ++i) x[i] *= scale_;
  }

  template <Index kUnits>
  [[gnu::noinline]] void add_units(const Packs<T>& theta, Index u, P* x) const {
    P w[kUnits], b[kUnits], v[kUnits];
    for (Index k = 0; k < kUnits; ++k) {
      w[k] = theta[u + k], b[k] = theta[units_ + u + k];
      v[k] = theta[2 * units_ + u + k];
    }
    for (Index i = 0; i < n_; ++i) {
      P sum = x[i];
      for (Index k = 0; k < kUnits; ++k)
        sum = fma_lanes(v[k], relu<T>(fma_lanes(w[k], gamma_[i], b[k])), sum);
      x[i] = sum;
    }
  }

  /// Moves a unit's three weights. With the sums of g and of g gamma over the
  /// examples that activate it, all of them follow: sum g h = w sum g gamma +
  /// b sum g.
  template <Index kUnits>
  [[gnu::noinline]] void step(Index u, const P* g) {
    P w[kUnits], b[kUnits], first[kUnits] = {}, zeroth[kUnits] = {};
    for (Index k = 0; k < kUnits; ++k)
      w[k] = theta_[u + k], b[k] = theta_[units_ + u + k];
    for (Index i = 0; i < n_; ++i) {
      const P gi = g[i], moment = gi * gamma_[i];
      for (Index k = 0; k < kUnits; ++k) {
        const auto active = fma_lanes(w[k], gamma_[i], b[k]) > P{};
        zeroth[k] += select(active, gi, P{});
        first[k] += select(active, moment, P{});
      }
    }
    for (Index k = 0; k < kUnits; ++k) {
      const P v = theta_[2 * units_ + u + k];
      moved_[u + k] = w[k] - rate_ * v * first[k];
      moved_[units_ + u + k] = b[k] - rate_ * v * zeroth[k];
      moved_[2 * units_ + u + k] =
          v - rate_ * (w[k] * first[k] + b[k] * zeroth[k]);
    }
  }

  Index units_, n_ = 0;
  T scale_, rate_;
  const P* gamma_ = nullptr;
  Packs<T> theta_, moved_, x_;
};

// ---- deep tanh networks ----------------------------------------------------

/// In float x p(x^2) / q(x^2) with the coefficients of Eigen's `ptanh`, up to
/// where tanh rounds to 1: relative error 3e-7 for any x. Networks this small
/// spend a third of their time here, and this takes half as long as by exp.
template <class P>
PHYSINV_LANES P activate(P x) {
  if constexpr (sizeof(LaneScalar<P>) == 4) {
    constexpr float kEnd = 7.99881172180175781F;
    constexpr float kAbove[] = {4.89352455891786e-3F,
                                6.37261928875436e-4F,
                                1.48572235717979e-5F,
                                5.12229709037114e-8F,
                                -8.60467152213735e-11F,
                                2.00018790482477e-13F,
                                -2.76076847742355e-16F};
    constexpr float kBelow[] = {4.89352518554385e-3F,
                                2.26843463243900e-3F,
                                1.18534705686654e-4F,
                                1.19825839466702e-6F};
    x = x > kEnd ? kEnd - P{} : x < -kEnd ? -kEnd - P{} : x;
    const P square = x * x;
    return x * polynomial(square, kAbove) / polynomial(square, kBelow);
  } else {
    return tanh_lanes(x);
  }
}

/// finish(p, q, sum_k a[p * ap + k * ak] b[q * bq + k * bk]), with as many
/// sums at a time as registers hold.
template <class T, Index kP, Index kQ, class F>
PHYSINV_LANES void product_tile(const Pack<T>* a,
                                Index ap,
                                Index ak,
                                const Pack<T>* b,
                                Index bq,
                                Index bk,
                                Index depth,
                                Index p,
                                Index q,
                                F& finish) {
  Pack<T> sum[kP][kQ] = {};
#pragma GCC unroll 4
  for (Index k = 0; k < depth; ++k) {
    Pack<T> right[kQ];
    for (Index j = 0; j < kQ; ++j) right[j] = held(b[(q + j) * bq + k * bk]);
    for (Index i = 0; i < kP; ++i) {
      const Pack<T> left = held(a[(p + i) * ap + k * ak]);
      for (Index j = 0; j < kQ; ++j)
        sum[i][j] = fma_lanes(left, right[j], sum[i][j]);
    }
  }
  for (Index i = 0; i < kP; ++i)
    for (Index j = 0; j < kQ; ++j) finish(p + i, q + j, sum[i][j]);
}

template <class T, class F>
void product(const Pack<T>* a,
             Index ap,
             Index ak,
             Index rows,
             const Pack<T>* b,
             Index bq,
             Index bk,
             Index cols,
             Index depth,
             F&& finish) {
  constexpr Index kP = 2, kQ = 4;
  Index p = 0;
  for (; p + kP <= rows; p += kP) {
    Index q = 0;
    for (; q + kQ <= cols; q += kQ)
      product_tile<T, kP, kQ>(a, ap, ak, b, bq, bk, depth, p, q, finish);
    for (; q < cols; ++q)
      product_tile<T, kP, 1>(a, ap, ak, b, bq, bk, depth, p, q, finish);
  }
  for (; p < rows; ++p)
    for (Index q = 0; q < cols; ++q)
      product_tile<T, 1, 1>(a, ap, ak, b, bq, bk, depth, p, q, finish);
}

/// Polynomials through the Chebyshev nodes cos(pi (m + 1/2) / M) of
/// [-range, range].
template <class T>
class Nodes {
 public:
  using P = Pack<T>;
  /// Networks of the usual initial weights need about as many for rounding.
  static constexpr Index kCount = sizeof(T) == 4 ? 16 : 40;

  explicit Nodes(double range) : inverse_(static_cast<T>(1 / range)) {
    for (Index m = 0; m < kCount; ++m) {
      const double angle =
          std::numbers::pi * (static_cast<double>(m) + 0.5) / kCount;
      at_[m] = static_cast<T>(range * math::cos(angle));
      for (Index k = 0; k < kCount; ++k)
        basis_[k][m] =
            static_cast<T>((k == 0 ? 1.0 : 2.0) / kCount *
                           math::cos(static_cast<double>(k) * angle));
    }
  }

  T at(Index m) const { return at_[m]; }

  /// out[i] = the polynomial through `values` at gamma[i].
  void interpolate(const P* values, const P* gamma, Index n, P* out) const {
    P c[kCount];
    for (Index k = 0; k < kCount; ++k) {
      c[k] = P{};
      for (Index m = 0; m < kCount; ++m)
        c[k] = fma_lanes(basis_[k][m], values[m], c[k]);
    }
    for (Index i = 0; i < n; ++i) {
      const P z = inverse_ * gamma[i], twice = z + z;
      P b1{}, b2{};
      for (Index k = kCount - 1; k > 0; --k) {
        const P b0 = fma_lanes(twice, b1, c[k] - b2);
        b2 = b1, b1 = b0;
      }
      out[i] = fma_lanes(z, b1, c[0] - b2);
    }
  }

  /// The transpose: weights of the nodes for weights g of the examples.
  void gather(const P* g, const P* gamma, Index n, P* weights) const {
    P moment[kCount] = {};
    for (Index i = 0; i < n; ++i) {
      const P z = inverse_ * gamma[i], twice = z + z;
      P last = g[i], now = g[i] * z;
      moment[0] += last;
      for (Index k = 1; k < kCount; ++k) {
        moment[k] += now;
        const P next = fma_lanes(twice, now, -last);
        last = now, now = next;
      }
    }
    for (Index m = 0; m < kCount; ++m) {
      weights[m] = P{};
      for (Index k = 0; k < kCount; ++k)
        weights[m] = fma_lanes(basis_[k][m], moment[k], weights[m]);
    }
  }

 private:
  T inverse_, at_[kCount], basis_[kCount][kCount];
};

template <class T>
class SmoothStep final : public OneStep<T> {
 public:
  using P = Pack<T>;

  explicit SmoothStep(const TinyNetOptions& o)
      : scale_(static_cast<T>(o.scale)),
        rate_(static_cast<T>(o.rate / o.scale)),
        through_nodes_(o.nodes),
        nodes_(o.range) {
    width_.push_back(1);
    width_.insert(width_.end(), o.hidden.begin(), o.hidden.end());
    width_.push_back(1);
    Index count = 0;
    for (Index l = 0; l < layers(); ++l) {
      offset_.push_back(count);
      count += width(l + 1) * (width(l) + 1);
    }
    theta_.take(count), moved_.take(count);
    activation_.resize(width_.size());
    bar_.resize(width_.size());
  }

  std::span<P> parameters() override { return theta_.span(); }
  std::vector<Index> fan_in() const override {
    std::vector<Index> all;
    for (Index l = 0; l < layers(); ++l)
      all.insert(all.end(),
                 static_cast<std::size_t>(width(l + 1) * (width(l) + 1)),
                 width(l));
    return all;
  }
  Index passes(Index n) const override {
    return condensed(n) ? Nodes<T>::kCount : n;
  }

  void predict(const P* gamma, Index n, P* x) override {
    gamma_ = gamma, examples_ = n, n_ = passes(n);
    P* in = activation_[0].take(n_);
    for (Index i = 0; i < n_; ++i)
      in[i] = condensed(n) ? all<T>(nodes_.at(i)) : gamma[i];
    forward(theta_, x_.take(n_));
    if (condensed(n)) return nodes_.interpolate(x_.data(), gamma, n, x);
    for (Index i = 0; i < n; ++i) x[i] = x_[i];
  }

  void respond(const P* g, P* delta) override {
    P* bar = bar_.back().take(n_);
    if (condensed(examples_)) {
      nodes_.gather(g, gamma_, examples_, bar);
    } else {
      for (Index i = 0; i < n_; ++i) bar[i] = g[i];
    }
    backward();
    // The second pass overwrites what the first one left for `backward`.
    std::swap(activation_, second_);
    activation_.resize(width_.size());
    std::swap(activation_[0], second_[0]);
    P* x = change_.take(n_);
    forward(moved_, x);
    std::swap(activation_[0], second_[0]);
    std::swap(activation_, second_);
    for (Index i = 0; i < n_; ++i) x[i] -= x_[i];
    if (condensed(examples_))
      return nodes_.interpolate(x, gamma_, examples_, delta);
    for (Index i = 0; i < n_; ++i) delta[i] = x[i];
  }

 private:
  Index layers() const { return static_cast<Index>(width_.size()) - 1; }
  Index width(Index l) const { return width_[static_cast<std::size_t>(l)]; }
  Index weights(Index l) const { return offset_[static_cast<std::size_t>(l)]; }
  Index biases(Index l) const { return weights(l) + width(l + 1) * width(l); }
  bool condensed(Index n) const {
    return through_nodes_ && n > Nodes<T>::kCount;
  }
  Packs<T>& activation(Index l) {
    return activation_[static_cast<std::size_t>(l)];
  }
  Packs<T>& bar(Index l) { return bar_[static_cast<std::size_t>(l)]; }

  void forward(const Packs<T>& theta, P* x) {
    const Index n = n_;
    for (Index l = 0; l < layers(); ++l) {
      const bool last = l + 1 == layers();
      const P* bias = theta.data() + biases(l);
      P* out = last ? x : activation(l + 1).take(width(l + 1) * n);
      const Index in = width(l);
      product<T>(theta.data() + weights(l),
                 in,
                 1,
                 width(l + 1),
                 activation(l).data(),
                 1,
                 n,
                 n,
                 in,
                 [=, scale = scale_](Index p, Index q, P sum) {
                   const P z = sum + bias[p];
                   out[p * n + q] = last ? scale * z : z;
                 });
      if (last) continue;
      for (Index i = 0; i < width(l + 1) * n; ++i) out[i] = activate(out[i]);
    }
  }

  /// From the cotangents of the output to the moved weights.
  void backward() {
    const Index n = n_;
    const T rate = rate_;
    for (Index l = layers(); l-- > 0;) {
      const Index in = width(l), out = width(l + 1);
      const P* y_bar = bar(l + 1).data();
      const P* a = activation(l).data();
      const P* w = theta_.data() + weights(l);
      P* w_moved = moved_.data() + weights(l);
      product<T>(y_bar, n, 1, out, a, n, 1, in, n, [=](Index p, Index q, P s) {
        w_moved[p * in + q] = fma_lanes(-rate, s, w[p * in + q]);
      });
      for (Index p = 0; p < out; ++p) {
        P sum{};
        for (Index i = 0; i < n; ++i) sum += y_bar[p * n + i];
        moved_[biases(l) + p] = theta_[biases(l) + p] - rate * sum;
      }
      if (l == 0) break;
      P* x_bar = bar(l).take(in * n);
      product<T>(w, 1, in, in, y_bar, 1, n, n, out, [=](Index p, Index q, P s) {
        const P y = a[p * n + q];
        x_bar[p * n + q] = s * fma_lanes(-y, y, 1 - P{});
      });
    }
  }

  std::vector<Index> width_, offset_;
  T scale_, rate_;
  bool through_nodes_;
  Nodes<T> nodes_;
  const P* gamma_ = nullptr;
  Index examples_ = 0, n_ = 0;  ///< as asked for, and as computed
  Packs<T> theta_, moved_, x_, change_;
  std::vector<Packs<T>> activation_, second_, bar_;
};

}  // namespace

std::string TinyNetOptions::layers() const {
  return fmt::format(
      "1-{}-1 {}", fmt::join(hidden, "-"), to_string(activation));
}

template <class T>
void OneStep<T>::initialize(StreamLanes<T>& random) {
  if (bounds_.empty())
    for (const Index fan : fan_in())
      bounds_.push_back(
          static_cast<T>(1 / std::sqrt(static_cast<double>(fan))));
  const auto theta = parameters();
  StreamLanes<T> local = random;  // stays in registers
  for (std::size_t i = 0; i < theta.size(); ++i)
    theta[i] = local.uniform(-bounds_[i], bounds_[i]);
  random = local;
}

template <class T>
std::unique_ptr<OneStep<T>> one_step(const TinyNetOptions& options) {
  SUITE_CHECK(!options.hidden.empty(), "a network must have a hidden layer");
  SUITE_CHECK(options.scale > 0 && options.range > 0,
              "scale and range must be positive");
  if (options.activation == TinyActivation::tanh)
    return std::make_unique<SmoothStep<T>>(options);
  SUITE_CHECK(options.hidden.size() == 1,
              "networks with ReLU must have one hidden layer");
  return std::make_unique<HingeStep<T>>(options);
}

template std::unique_ptr<OneStep<float>> one_step(const TinyNetOptions&);
template std::unique_ptr<OneStep<double>> one_step(const TinyNetOptions&);
template class OneStep<float>;
template class OneStep<double>;

}  // namespace physinv
