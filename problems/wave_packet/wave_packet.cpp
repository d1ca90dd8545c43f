#include "problems/wave_packet/wave_packet.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "suite/core/check.h"
#include "suite/core/math_lanes.h"
#include "suite/core/option_check.h"
#include "suite/core/simd/pack.h"

namespace physinv {
namespace {

enum Slot : std::size_t { kSlopes, kSpans };

/// Packs side by side, so that no chain waits for itself; of one number of
/// samples for every width of the registers, which sums and spans depend on.
constexpr int kPacks = 256 / kVectorBytes;
template <class T>
constexpr Index kBlock = kPacks* kLanes<T>;

/// Where the envelope ends, in widths. In double where exp underflows: the
/// sign of a slope of 1e-40 decides where gradient descent looks next. In
/// float, for networks alone, where it is below 1e-17.
template <class T>
constexpr double kReach = 38.61;
template <>
constexpr double kReach<float> = 8.85;

/// Of all numbers of a block: four parts side by side, then one by one.
template <class T>
PHYSINV_LANES T sum_block(const Pack<T> (&sums)[kPacks]) {
  constexpr Index kPart = kBlock<T> / 4;
  alignas(64) T all[kBlock<T>];
  std::memcpy(all, sums, sizeof(all));
  T sum = 0;
  for (Index i = 0; i < kPart; ++i)
    sum +=
        (all[i] + all[kPart + i]) + (all[2 * kPart + i] + all[3 * kPart + i]);
  return sum;
}

/// first, first * ratio, ... of one block, by doubling: few roundings each.
template <class T>
PHYSINV_LANES void powers(double first, double ratio, Pack<T> (&out)[kPacks]) {
  double p[kBlock<T>];
  p[0] = first;
  for (Index n = 1; n < kBlock<T>; n *= 2) {
    for (Index i = 0; i < n; ++i) p[n + i] = p[i] * ratio;
    ratio *= ratio;
  }
  alignas(64) T rounded[kBlock<T>];
  for (Index i = 0; i < kBlock<T>; ++i) rounded[i] = static_cast<T>(p[i]);
  std::memcpy(out, rounded, sizeof(out));
}

/// Sum of a(i) b(i).
template <class T>
T dot(const T* a, const T* b, Index count) {
  Pack<T> sums[kPacks] = {};
  for (Index i = 0; i < count; i += kBlock<T>)
    for (int k = 0; k < kPacks; ++k)
      sums[k] = fma_lanes(load<Pack<T>>(a + i + k * kLanes<T>),
                          load<Pack<T>>(b + i + k * kLanes<T>),
                          sums[k]);
  return sum_block<T>(sums);
}

template <class T>
double half_square(const T* y, const T* target, Index count) {
  constexpr int W = kLanes<double>;
  Pack<double> sums[kPacks] = {};
  for (Index i = 0; i < count; i += kPacks * W)
    for (int k = 0; k < kPacks; ++k) {
      const auto r = load<Pack<T, W>>(y + i + k * W) -
                     load<Pack<T, W>>(target + i + k * W);
      const auto d = __builtin_convertvector(r, Pack<double>);
      sums[k] = fma_lanes(d, d, sums[k]);
    }
  return 0.5 * sum_block<double>(sums);
}

template <class T>
class WavePacket final : public Problem<T>, public Vjp<T>, public Jacobian<T> {
 public:
  explicit WavePacket(const WavePacketOptions& o) : options_(o) {
    check_numbers<T>({{"amplitude", o.amplitude},
                      {"frequency", o.frequency},
                      {"phase", o.phase},
                      {"width", o.width},
                      {"centre", o.centre},
                      {"scale", o.scale},
                      {"noise", o.noise},
                      {"range", o.range[0]},
                      {"range", o.range[1]}});
    SUITE_CHECK(o.samples > 0 && o.samples % 64 == 0,
                "the number of samples must be a positive multiple of 64");
    // Below, the correction for the fraction of t0 would leave float's range.
    SUITE_CHECK(o.width >= 1, "width must be at least 1");
    SUITE_CHECK(o.scale > 0 && o.noise >= 0 && o.range[0] <= o.range[1],
                "scale must be positive, noise must not be negative, range "
                "must be a range");
    const double s = o.width;
    tables_.reach = static_cast<Index>(std::ceil(kReach<T> * s));
    const Index first = -tables_.reach - kBlock<T>;
    const auto size = static_cast<std::size_t>(1 - 2 * first);
    tables_.cosine.assign(size, T(0)), tables_.sine.assign(size, T(0));
    for (Index m = -tables_.reach; m <= tables_.reach; ++m) {
      const auto d = static_cast<double>(m);
      const double envelope = o.amplitude * math::exp(-d * d / (2 * s * s));
      const auto at = static_cast<std::size_t>(m - first);
      tables_.cosine[at] =
          static_cast<T>(envelope * math::cos(o.frequency * d));
      tables_.sine[at] = static_cast<T>(envelope * math::sin(o.frequency * d));
    }
  }

  Shape shape() const override {
    return {1, options_.samples, options_.samples};
  }
  Vector<double> start() const override { return Vector<double>::Zero(1); }

  void draw(Stream& stream, SampleOut& sample) const override {
    const double t0 = stream.uniform(options_.range[0], options_.range[1]);
    sample.x(0) = (t0 - options_.centre) / options_.scale;
    stream.normals(sample.given.data(), options_.samples);
    sample.given *= options_.noise;
  }
  /// The noise.
  void hide(BatchOut<double> given) const override { given.setZero(); }

  void forward(Point<T> at, BatchOut<T> y, Workspace& work) const override {
    const auto &x = at.x, &given = at.given;
    const Index n = options_.samples;
    Index drawn = 0;
    for (Index i = 0; i < x.cols(); ++i) {
      const Span span =
          packet<false>(x(0, i), given.col(i).data(), y.col(i).data(), nullptr);
      drawn += span.last - span.first;
    }
    work.counts[Counter::skipped_zeros] +=
        static_cast<std::uint64_t>(n * x.cols() - drawn);
  }
  /// Keeps du/dt0 and where it is not 0.
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const auto &x = at.x, &given = at.given;
    const Index n = options_.samples;
    auto slopes = tape.slot<T>(kSlopes, n, x.cols());
    auto spans = tape.slot<Index>(kSpans, 2, x.cols());
    Index drawn = 0;
    for (Index i = 0; i < x.cols(); ++i) {
      const Span span = packet<true>(
          x(0, i), given.col(i).data(), y.col(i).data(), slopes.col(i).data());
      spans(0, i) = span.first, spans(1, i) = span.last;
      drawn += span.last - span.first;
    }
    tape.counts[Counter::skipped_zeros] +=
        static_cast<std::uint64_t>(n * x.cols() - drawn);
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace&) const override {
    const auto slopes = tape.view<T>(kSlopes);
    const auto spans = tape.view<Index>(kSpans);
    for (Index i = 0; i < slopes.cols(); ++i) {
      const Index first = spans(0, i), count = spans(1, i) - first;
      x_bar(0, i) =
          static_cast<T>(options_.scale) *
          dot(slopes.col(i).data() + first, y_bar.col(i).data() + first, count);
    }
  }
  void jacobian(Point<T> at, BatchOut<T> j, Workspace& work) const override {
    const auto &x = at.x, &given = at.given;
    const Index n = options_.samples;
    Workspace::Scope scope(work);
    auto y = work.take<T>(n, 1);
    for (Index i = 0; i < x.cols(); ++i) {
      const Span span =
          packet<true>(x(0, i), given.col(i).data(), y.data(), j.col(i).data());
      j.col(i).head(span.first).setZero();
      j.col(i).tail(n - span.last).setZero();
      j.col(i) *= static_cast<T>(options_.scale);
    }
  }

  /// Squared error or half of it, in lanes of double added up in a fixed order:
  /// signals with the same bits have the same loss, in each of these functions.
  void loss(BatchIn<T> y,
            BatchIn<T> target,
            VectorOut<double> loss) const override {
    for (Index i = 0; i < y.cols(); ++i)
      loss(i) =
          half_square(y.col(i).data(), target.col(i).data(), options_.samples);
    if (!options_.half_loss) loss *= 2;
  }
  void loss_gradient(BatchIn<T> y,
                     BatchIn<T> target,
                     BatchOut<T> y_bar) const override {
    Problem<T>::loss_gradient(y, target, y_bar);
    if (!options_.half_loss) y_bar *= T(2);
  }

  /// Six per sample, and four transcendental functions of 20 each.
  double operations() const override {
    return 6 * static_cast<double>(options_.samples) + 80;
  }

 private:
  /// cos(w m) and sin(w m) times exp(-m^2 / (2 s^2)) at integers m, 0 beyond
  /// the reach, with a block of zeros on either side.
  struct Tables {
    std::vector<T> cosine, sine;
    Index reach = 0;  ///< largest |m| that counts
  };
  /// Samples first .. last - 1 of a signal.
  struct Span {
    Index first, last;
  };

  /// One signal; returns where its packet, and slope, may differ from 0.
  template <bool kSlope>
  Span packet(T xi, const T* given, T* y, T* slope) const {
    const Index n = options_.samples;
    if (!std::isfinite(xi)) {
      constexpr T kNan = std::numeric_limits<T>::quiet_NaN();
      std::fill_n(y, n, kNan);
      if constexpr (kSlope) std::fill_n(slope, n, kNan);
      return {0, n};
    }
    // In double also for float: far away the fraction of t0 is what counts.
    const double t0 =
        options_.centre + options_.scale * static_cast<double>(xi);
    const auto reach = static_cast<double>(tables_.reach);
    const bool seen =
        t0 + 0.5 >= 1 - reach && t0 - 0.5 < static_cast<double>(n) + reach;
    Span span{0, 0};
    if (seen) {
      const auto c = static_cast<Index>(std::floor(t0 + 0.5));
      const Index from = std::max<Index>(c - tables_.reach, 1) - 1;
      const Index to = std::min(c + tables_.reach, n);
      span = {from / kBlock<T> * kBlock<T>,
              (to + kBlock<T> - 1) / kBlock<T> * kBlock<T>};
      render<kSlope>(t0, span, given, y, slope);
    }
    std::copy_n(given, span.first, y);
    std::copy_n(given + span.last, n - span.last, y + span.last);
    return span;
  }
  /// With c the integer next to t0, f = t0 - c and m = t - c,
  ///   exp(-d^2 / (2 s^2)) = exp(-m^2 / (2 s^2)) exp(m f / s^2 - f^2 / (2
  ///   s^2)), cos(w d + p) = cos(w m) cos(w f - p) + sin(w m) sin(w f - p):
  /// two tables over m and a geometric sequence. Every fused operation is
  /// written out, because forward and linearize must agree to the last bit.
  template <bool kSlope>
  [[gnu::noinline]] void render(
      double t0, Span span, const T* given, T* y, T* slope) const {
    using P = Pack<T>;
    constexpr int W = kLanes<T>;
    const double w = options_.frequency;
    const double narrow = 1 / (options_.width * options_.width);
    const double c = std::floor(t0 + 0.5), f = t0 - c, rate = f * narrow;
    const double m0 = static_cast<double>(span.first + 1) - c;
    const double turn = std::fma(w, f, -options_.phase);
    const auto [sine, cosine] = math::sincos(turn);

    P growth[kPacks];
    const auto steps = math::exp(Pack<double, 4>{
        (m0 - 0.5 * f) * rate, rate, static_cast<double>(kBlock<T>) * rate});
    powers<T>(steps[0], steps[1], growth);
    const P per_block = P{} + static_cast<T>(steps[2]);
    const P a = P{} + static_cast<T>(cosine), b = P{} + static_cast<T>(sine);
    const P wa = P{} + static_cast<T>(w * cosine);
    const P wb = P{} - static_cast<T>(w * sine);
    const P slant = P{} + static_cast<T>(narrow);
    const P back = P{} - static_cast<T>(rate);
    P m{};
    for (int k = 0; k < W; ++k) m[k] = static_cast<T>(m0 + k);

    const Index table =
        span.first + 1 - static_cast<Index>(c) + tables_.reach + kBlock<T>;
    const T* cosines = tables_.cosine.data() + table;
    const T* sines = tables_.sine.data() + table;
    given += span.first, y += span.first;
    if constexpr (kSlope) slope += span.first;
    for (Index i = 0; i < span.last - span.first; i += kBlock<T>) {
      for (int k = 0; k < kPacks; ++k) {
        const Index at = i + k * W;
        const P cm = load<P>(cosines + at), sm = load<P>(sines + at);
        const P wave = fma_lanes(a, cm, b * sm);
        store(y + at, fma_lanes(wave, growth[k], load<P>(given + at)));
        if constexpr (kSlope) {
          const P quadrature = fma_lanes(wa, sm, wb * cm);
          const P d = fma_lanes(m, slant, back);
          store(slope + at, growth[k] * fma_lanes(wave, d, quadrature));
          m += static_cast<T>(W);
        }
        growth[k] *= per_block;
      }
    }
  }

  WavePacketOptions options_;
  Tables tables_;
};

}  // namespace

ProblemRecipe problems::wave_packet(const WavePacketOptions& options) {
  return problem<WavePacket>("wave_packet",
                             options,
                             {.unknowns = {"xi"},
                              .observations = {"signal(sample)"},
                              .given = {"disturbance(sample)"}});
}

}  // namespace physinv
