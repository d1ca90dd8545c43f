#include "problems/heat/heat.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "suite/core/check.h"
#include "suite/core/lanes_math.h"
#include "suite/core/threads.h"

namespace physinv {
namespace {

using P = Pack<double>;
constexpr Index kWidth = kLanes<double>;

enum Slot : std::size_t { kPoison, kScratch };

/// Fields first .. first+count-1, one per lane; the last one fills what is left
/// of the register.
struct Block {
  Index first, count;

  template <class T>
  void load(BatchIn<T> batch, P* out) const {
    const T* column[kWidth];
    for (Index k = 0; k < kWidth; ++k)
      column[k] = batch.col(first + std::min(k, count - 1)).data();
    for (Index r = 0; r < batch.rows(); ++r)
      for (Index k = 0; k < kWidth; ++k)
        out[r][k] = static_cast<double>(column[k][r]);
  }
  template <class T>
  void store(const P* in, BatchOut<T>& batch) const {
    for (Index k = 0; k < count; ++k) {
      T* const column = batch.col(first + k).data();
      for (Index r = 0; r < batch.rows(); ++r)
        column[r] = static_cast<T>(in[r][k]);
    }
  }
};

/// The parts of a thread's memory.
struct Fields {
  P *u, *v, *z, *scratch;

  static Index numbers(const PlaneFft& fft) {
    return kWidth * (2 * fft.field() + fft.spectrum() + fft.scratch());
  }
  Fields(const PlaneFft& fft, double* memory)
      : u(reinterpret_cast<P*>(memory)),
        v(u + fft.field()),
        z(v + fft.field()),
        scratch(z + fft.spectrum()) {}
};

Index count_of(const Threads* threads) {
  return threads != nullptr ? threads->count() : 1;
}

/// f(block, fields) for all samples, a register of them at a time.
template <class F>
void for_registers(const PlaneFft& fft,
                   Scratch<double> memory,
                   Threads* threads,
                   Index samples,
                   F&& f) {
  const Index blocks = (samples + kWidth - 1) / kWidth;
  for_blocks(threads, blocks, [&](Index b, int thread) {
    const Index first = b * kWidth;
    f(Block{first, std::min(kWidth, samples - first)},
      Fields(fft, memory.col(thread).data()));
  });
}

/// |Z| beyond so many times n e^-s leaves nothing of S.
constexpr double kVanishes = 39;

/// `HeatMode::of`, lane by lane: 1 / expected and 1 / uncertainty for the
/// scales, e^-s for a mode without signal.
struct Modes {
  P probability, gain;

  PHYSINV_LANES static Modes of(P amplitude,
                                double s,
                                double damping,
                                double per_expected,
                                P per_uncertainty) {
    P z[] = {amplitude * per_expected, amplitude * per_uncertainty};
    // As squares of roots, which reach down to zero.
    for (P& v : z) v *= -0.25 * v;
    exp_lanes(z);
    for (P& v : z) v = held(0.5 * v * v);
    const P zero{}, signal = select(z[0] == z[0], z[0], zero);
    const P all = signal + z[1];
    const P p = select(all == zero, zero, signal / all);
    const P w = select((p <= 0.5) | (p >= 0.68), 2 * (p - 0.5), zero);
    const P root = exp_lanes(0.5 * s * w);
    return {p, select(w == -1 - zero, damping - zero, root * root)};
  }
};

/// What one mode of dy is multiplied by. Adds to `skipped` the lanes that
/// cannot hold a signal.
PHYSINV_LANES P gain_of(P re,
                        P im,
                        double s,
                        double expected,
                        double damping,
                        P per_uncertainty,
                        Mask<double>& skipped) {
  const P squares = fma_lanes(re, re, im * im);
  const double vanishes = kVanishes * expected;
  const auto noise = beyond<double>(squares, vanishes * vanishes);
  skipped -= noise;
  const P nothing = damping - P{};
  if (count_set(noise) == kWidth) return nothing;
  const P found =
      Modes::of(sqrt_lanes(squares), s, damping, 1 / expected, per_uncertainty)
          .gain;
  return select(noise, nothing, found);
}

/// sqrt sum (1e-6 |dy| + floor)^2
P uncertainty_of(const P* dy, Index cells, double floor) {
  P sum{};
  for (Index r = 0; r < cells; ++r) {
    const P e = fma_lanes(abs_lanes(dy[r]), P{} + 1e-6, P{} + floor);
    sum = fma_lanes(e, e, sum);
  }
  return sqrt_lanes(sum);
}

/// 0, or NaN if some entry is not finite: P knows no point, but a derivative
/// taken at such a point must say so.
template <class T>
T poison(const T* x, Index cells) {
  T sum = 0;
  for (Index r = 0; r < cells; ++r) sum += T(0) * x[r];
  return sum;
}

}  // namespace

Options describe(const HeatOptions& o) {
  return {{"resolution", fmt::format("{}", o.resolution)},
          {"end_time", fmt::format("{}", o.end_time)},
          {"noise_floor", fmt::format("{}", o.noise_floor)}};
}

void add_rectangle(HeatRectangle r, Index n, double* field) {
  const auto side = static_cast<double>(n);
  Index from[2], to[2];
  for (std::size_t a = 0; a < 2; ++a) {
    const double half = r.half_size[a];
    double& c = r.centre[a];
    c = std::min(std::max(c, half), side - half);
    from[a] = std::max(Index{0}, static_cast<Index>(std::floor(c - half - 1)));
    to[a] = std::min(n, static_cast<Index>(std::ceil(c + half + 1)));
  }
  const auto beyond_edge = [&](std::size_t a, Index i) {
    return std::abs(double(i) + 0.5 - r.centre[a]) - r.half_size[a];
  };
  for (Index i = from[0]; i < to[0]; ++i)
    for (Index j = from[1]; j < to[1]; ++j) {
      const double d = std::max(beyond_edge(0, i), beyond_edge(1, j));
      const double share = std::clamp(0.5 - d / std::sqrt(0.5), 0.0, 1.0);
      double& cell = field[n * i + j];
      cell = std::fma(r.strength, share, cell);
    }
}

HeatMode HeatMode::of(double amplitude,
                      double exponent,
                      double expected,
                      double uncertainty) {
  const Modes all = Modes::of(amplitude - P{},
                              exponent,
                              std::exp(-exponent),
                              1 / expected,
                              1 / uncertainty - P{});
  return {all.probability[0], all.gain[0]};
}

/// Without the subtraction, and without e^s where nothing is left of e^-s.
Batch<double> heat_gradient_descent(const Batch<double>& exponents,
                                    Index steps) {
  return exponents.unaryExpr([=](double s) {
    const double damping = std::exp(-s);
    if (damping == 0 || steps == 0) return 0.0;
    return -std::expm1(double(steps) * std::log1p(-damping * damping)) /
           damping;
  });
}

template <class T>
Heat<T>::Heat(const Options& o) : options_(o), fft_(o.resolution) {
  SUITE_CHECK(o.resolution >= 8, "resolution must be at least 8");
  SUITE_CHECK(o.end_time > 0, "end_time must be positive");
  SUITE_CHECK(o.noise_floor >= 0, "noise_floor must not be negative");
  const auto n = static_cast<double>(o.resolution);
  const Index m = fft_.positions();
  exponents_.resize(m, m), s_.resize(m, m), expected_.resize(m, m);
  const Vector<double> along = Vector<double>::NullaryExpr(m, [&](Index k) {
    const double angle = 2 * std::numbers::pi * (double(k) / n);
    return angle * angle * o.end_time;
  });
  for (Index l = 0; l < m; ++l)
    for (Index k = 0; k < m; ++k) exponents_(k, l) = along(k) + along(l);
  const Batch<double> damping =
      exponents_.unaryExpr([](double s) { return std::exp(-s); });
  for (Index q = 0; q < m; ++q)
    for (Index p = 0; p < m; ++p) {
      s_(p, q) = exponents_(fft_.mode(p), fft_.mode(q));
      expected_(p, q) = n * damping(fft_.mode(p), fft_.mode(q));
    }
  damping_ = scaled(damping);
}

/// By position, with the scale of the inverse transform.
template <class T>
Batch<double> Heat<T>::scaled(const Batch<double>& gain) const {
  const Index m = fft_.positions();
  SUITE_CHECK(gain.rows() == m && gain.cols() == m, "a gain for every mode");
  const double scale = 1 / static_cast<double>(fft_.field());
  return Batch<double>::NullaryExpr(m, m, [&](Index p, Index q) {
    return gain(fft_.mode(p), fft_.mode(q)) * scale;
  });
}

template <class T>
Shape Heat<T>::shape() const {
  return {fft_.field(), fft_.field(), 0};
}

template <class T>
Vector<double> Heat<T>::start() const {
  return Vector<double>::Zero(fft_.field());
}

template <class T>
double Heat<T>::operations() const {
  const auto cells = static_cast<double>(fft_.field());
  return cells * (5 * std::log2(cells) + 1);
}

template <class T>
Samples<double> Heat<T>::sample(Index first,
                                Index count,
                                const Rng& rng) const {
  const Index n = options_.resolution, cells = fft_.field();
  Samples<double> out;
  out.x.setZero(cells, count), out.y.resize(cells, count);
  out.given.resize(0, count);
  const double side = double(n), middle = side / 2;
  for (Index i = 0; i < count; ++i) {
    Stream stream = rng.child(static_cast<std::uint64_t>(first + i)).stream();
    const auto rectangles = static_cast<int>(4 + 7 * stream.uniform());
    for (int k = 0; k < rectangles; ++k) {
      HeatRectangle r{};
      for (double& c : r.centre)
        c = std::fma(0.8 * (stream.uniform() - 0.5), side, middle);
      for (double& h : r.half_size) h = stream.uniform(0, 10);
      r.strength = stream.uniform();
      add_rectangle(r, n, out.x.col(i).data());
    }
  }
  Workspace work;
  Heat<double>(options_).forward(out.x, out.given, out.y, work);
  return out;
}

template <class T>
void Heat<T>::apply(BatchIn<T> in,
                    const Batch<double>& gain,
                    BatchOut<T>& out,
                    Scratch<double> memory,
                    Threads* threads) const {
  check_size(in, fft_.field(), in.cols());
  check_size(out, fft_.field(), in.cols());
  for_registers(
      fft_, memory, threads, in.cols(), [&](const Block& block, Fields f) {
        block.load<T>(in, f.u);
        fft_.forward(f.u, f.z, f.scratch);
        fft_.scale(f.z, gain);
        fft_.inverse(f.z, f.u, f.scratch);
        block.store<T>(f.u, out);
      });
}

template <class T>
void Heat<T>::filter(BatchIn<T> in,
                     const Batch<double>& gain,
                     BatchOut<T> out,
                     Workspace& work) const {
  const Workspace::Scope scope(work);
  const auto memory =
      work.take<double>(Fields::numbers(fft_), count_of(work.threads()));
  apply(in, scaled(gain), out, memory, work.threads());
}

template <class T>
void Heat<T>::forward(BatchIn<T> x,
                      BatchIn<T> /*given*/,
                      BatchOut<T> y,
                      Workspace& work) const {
  const Workspace::Scope scope(work);
  const auto memory =
      work.take<double>(Fields::numbers(fft_), count_of(work.threads()));
  apply(x, damping_, y, memory, work.threads());
}

template <class T>
void Heat<T>::linearize(BatchIn<T> x,
                        BatchIn<T> /*given*/,
                        BatchOut<T> y,
                        Tape& tape) const {
  auto kept = tape.slot<T>(kPoison, 1, x.cols());
  for (Index i = 0; i < x.cols(); ++i)
    kept(0, i) = poison(x.col(i).data(), x.rows());
  const auto memory = tape.slot<double>(
      kScratch, Fields::numbers(fft_), count_of(tape.threads()));
  apply(x, damping_, y, memory, tape.threads());
}

template <class T>
void Heat<T>::pullback(const Tape& tape,
                       BatchIn<T> y_bar,
                       BatchOut<T> x_bar,
                       Workspace& work) const {
  const auto kept = tape.view<T>(kPoison);
  forward(y_bar, y_bar.topRows(0), x_bar, work);
  for (Index i = 0; i < kept.cols(); ++i) x_bar.col(i).array() += kept(0, i);
}

template <class T>
void Heat<T>::invert(BatchIn<T> y,
                     BatchIn<T> /*given*/,
                     BatchIn<T> x_guess,
                     BatchOut<T> x,
                     Workspace& work) const {
  const Index cells = fft_.field();
  const auto side = static_cast<double>(fft_.size());
  for (const auto* b : {&y, &x_guess}) check_size(*b, cells, x.cols());
  check_size(x, cells, x.cols());
  const Workspace::Scope scope(work);
  const auto memory =
      work.take<double>(Fields::numbers(fft_), count_of(work.threads()));
  const double scale = 1 / static_cast<double>(cells);
  std::atomic<std::uint64_t> skipped = 0;
  const auto run = [&](const Block& block, Fields f) {
    block.load<T>(x_guess, f.u);
    fft_.forward(f.u, f.z, f.scratch);
    fft_.scale(f.z, damping_);
    fft_.inverse(f.z, f.u, f.scratch);
    block.load<T>(y, f.v);
    for (Index r = 0; r < cells; ++r) f.v[r] -= f.u[r];
    const P per_noise = 1 / uncertainty_of(f.v, cells, options_.noise_floor);

    fft_.forward(f.v, f.z, f.scratch);
    Mask<double> none{};
    fft_.scale_modes(f.z, [&](Index p, Index q, P re, P im) {
      const double e = expected_(p, q);
      return gain_of(re, im, s_(p, q), e, e / side, per_noise, none);
    });
    fft_.inverse(f.z, f.u, f.scratch);
    block.load<T>(x_guess, f.v);
    for (Index r = 0; r < cells; ++r)
      f.u[r] = fma_lanes(f.u[r], P{} + scale, f.v[r]);
    block.store<T>(f.u, x);
    for (Index k = 0; k < block.count; ++k)
      skipped += static_cast<std::uint64_t>(none[k]);
  };
  for_registers(fft_, memory, work.threads(), x.cols(), run);
  work.counts[Counter::skipped_zeros] += skipped;
}

template class Heat<float>;
template class Heat<double>;

}  // namespace physinv
