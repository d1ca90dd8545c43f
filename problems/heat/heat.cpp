#include "problems/heat/heat.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "problems/heat/likelihood.h"
#include "problems/heat/registers.h"
#include "suite/core/check.h"
#include "suite/core/linear_problem.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"

namespace physinv {
namespace {

using namespace heat_lanes;

enum Slot : std::size_t { kPoison, kScratch };

/// 0, or NaN if some entry is not finite: P does not depend on the point, but a
/// derivative taken at such a point must say so.
template <class T>
T poison(const T* x, Index cells) {
  T sum = 0;
  for (Index r = 0; r < cells; ++r) sum += T(0) * x[r];
  return sum;
}

}  // namespace

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
                              math::exp(-exponent),
                              math::exp(exponent),
                              1 / expected,
                              1 / uncertainty - P{});
  return {all.probability[0], all.gain[0]};
}

/// Without the subtraction, and without e^s where nothing is left of e^-s.
Batch<double> heat_gradient_descent(const Batch<double>& exponents,
                                    Index steps) {
  return exponents.unaryExpr([=](double s) {
    const double damping = math::exp(-s);
    if (damping == 0 || steps == 0) return 0.0;
    return -math::expm1(double(steps) * math::log1p(-damping * damping)) /
           damping;
  });
}

HeatTable::HeatTable(const HeatOptions& o, const PlaneFft& fft) {
  const auto n = static_cast<double>(o.resolution);
  const Index m = fft.positions();
  const auto along = [&](Index p) {
    const double angle = 2 * std::numbers::pi * (double(fft.mode(p)) / n);
    return angle * angle * o.end_time;
  };
  s = Batch<double>::NullaryExpr(
      m, m, [&](Index p, Index q) { return along(p) + along(q); });
  damping = s.unaryExpr([](double e) { return math::exp(-e); });
  amplification = s.unaryExpr([](double e) { return math::exp(e); });
  expected = n * damping;
}

namespace {

/// A field for every thread, within a scope of `work`.
Scratch<double> memory_of(const PlaneFft& fft, Workspace& work) {
  return work.take<double>(Fields::numbers(fft), count_of(work.threads()));
}

/// out = F^-1 (gain F in), by position and without the scale of the inverse.
template <class T>
void apply(const PlaneFft& fft,
           BatchIn<T> in,
           const Batch<double>& gain,
           BatchOut<T>& out,
           Scratch<double> memory,
           Threads* threads) {
  for_fields(fft, memory, threads, in.cols(), [&](const Block& b, Fields f) {
    b.load<T>(in, f.u);
    fft.forward(f.u, f.z, f.scratch);
    fft.scale(f.z, gain);
    fft.inverse(f.z, f.u, f.scratch);
    b.store<T>(f.u, out);
  });
}

}  // namespace

HeatModes::HeatModes(const HeatOptions& o)
    : options_(o), fft_(o.resolution), table_(o, fft_) {
  const Index m = fft_.positions();
  exponents_.resize(m, m);
  for (Index q = 0; q < m; ++q)
    for (Index p = 0; p < m; ++p)
      exponents_(fft_.mode(p), fft_.mode(q)) = table_.s(p, q);
}

template <class T>
void HeatModes::filter(BatchIn<T> in,
                       const Batch<double>& gain,
                       BatchOut<T> out,
                       Workspace& work) const {
  const Index m = fft_.positions();
  SUITE_CHECK(gain.rows() == m && gain.cols() == m,
              "gain must have an entry for every mode");
  check_size(in, fft_.field(), in.cols());
  check_size(out, fft_.field(), in.cols());
  const double scale = 1 / static_cast<double>(fft_.field());
  const Batch<double> scaled =
      Batch<double>::NullaryExpr(m, m, [&](Index p, Index q) {
        return gain(fft_.mode(p), fft_.mode(q)) * scale;
      });
  const Workspace::Scope scope(work);
  apply<T>(fft_, in, scaled, out, memory_of(fft_, work), work.threads());
}

template void HeatModes::filter<float>(BatchIn<float>,
                                       const Batch<double>&,
                                       BatchOut<float>,
                                       Workspace&) const;
template void HeatModes::filter<double>(BatchIn<double>,
                                        const Batch<double>&,
                                        BatchOut<double>,
                                        Workspace&) const;

namespace {

template <class T>
const HeatOptions& checked(const HeatOptions& o) {
  check_numbers<T>({{"end_time", o.end_time}, {"noise_floor", o.noise_floor}});
  SUITE_CHECK(o.resolution >= 8, "resolution must be at least 8");
  SUITE_CHECK(o.end_time > 0, "end_time must be positive");
  SUITE_CHECK(o.noise_floor >= 0, "noise_floor must not be negative");
  return o;
}

template <class T>
class Heat final : public LinearProblem<T>, public Inverse<T> {
 public:
  explicit Heat(const HeatOptions& o)
      : modes_(checked<T>(o)),
        damping_(modes_.table().damping / double(fft_.field())) {}

  const HeatOptions& options() const { return modes_.options(); }

  Shape shape() const override { return {fft_.field(), fft_.field(), 0}; }
  Vector<double> start() const override {
    return Vector<double>::Zero(fft_.field());
  }

  void draw(Stream& stream, SampleOut& sample) const override {
    const Index n = modes_.options().resolution;
    const double side = double(n), middle = side / 2;
    const auto rectangles = static_cast<int>(4 + 7 * stream.uniform());
    for (int k = 0; k < rectangles; ++k) {
      HeatRectangle r{};
      for (double& c : r.centre)
        c = std::fma(0.8 * (stream.uniform() - 0.5), side, middle);
      for (double& h : r.half_size) h = stream.uniform(0, 10);
      r.strength = stream.uniform();
      add_rectangle(r, n, sample.x.data());
    }
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace& work) const override {
    diffuse(at.x, y, work);
  }
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const auto& x = at.x;
    auto kept = tape.slot<T>(kPoison, 1, x.cols());
    for (Index i = 0; i < x.cols(); ++i)
      kept(0, i) = poison(x.col(i).data(), x.rows());
    const auto memory = tape.slot<double>(
        kScratch, Fields::numbers(fft_), count_of(tape.threads()));
    apply<T>(fft_, x, damping_, y, memory, tape.threads());
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    const auto kept = tape.view<T>(kPoison);
    diffuse(y_bar, x_bar, work);
    for (Index i = 0; i < kept.cols(); ++i) x_bar.col(i).array() += kept(0, i);
  }
  /// `skipped_zeros` counts modes whose probability is known without their
  /// likelihoods, more than half of the plane.
  void invert(Point<T> near,
              BatchIn<T> y,
              BatchOut<T> x,
              Workspace& work) const override {
    const auto& x_guess = near.x;
    const Index cells = fft_.field();
    const Workspace::Scope scope(work);
    const auto memory = memory_of(fft_, work);
    const double scale = 1 / static_cast<double>(cells);
    std::atomic<std::uint64_t> skipped = 0;
    const auto run = [&](const Block& block, Fields f) {
      block.load<T>(x_guess, f.u);
      fft_.forward(f.u, f.z, f.scratch);
      fft_.scale(f.z, damping_);
      fft_.inverse(f.z, f.u, f.scratch);
      block.load<T>(y, f.v);
      for (Index r = 0; r < cells; ++r) f.v[r] -= f.u[r];
      const Uncertainty uncertainty(
          uncertainty_of(f.v, cells, 1, options().noise_floor));

      fft_.forward(f.v, f.z, f.scratch);
      Mask<double> known{};
      fft_.scale_modes(f.z, [&](Index p, Index q, P re, P im) {
        return gain_of(re, im, modes_.table(), p, q, uncertainty, known);
      });
      fft_.inverse(f.z, f.u, f.scratch);
      block.load<T>(x_guess, f.v);
      for (Index r = 0; r < cells; ++r)
        f.u[r] = fma_lanes(f.u[r], P{} + scale, f.v[r]);
      block.store<T>(f.u, x);
      for (Index k = 0; k < block.count; ++k)
        skipped += static_cast<std::uint64_t>(known[k]);
    };
    for_fields(fft_, memory, work.threads(), x.cols(), run);
    work.counts[Counter::skipped_zeros] += skipped;
  }

  double operations() const override {
    const auto cells = static_cast<double>(fft_.field());
    return cells * (5 * math::log2(cells) + 1);
  }

 private:
  void diffuse(BatchIn<T> in, BatchOut<T>& out, Workspace& work) const {
    const Workspace::Scope scope(work);
    apply<T>(fft_, in, damping_, out, memory_of(fft_, work), work.threads());
  }

  HeatModes modes_;
  const PlaneFft& fft_ = modes_.fft();
  Batch<double> damping_;  ///< by position, e^-s / n^2
};

}  // namespace

const HeatOptions* heat_options(const Problem<double>& problem) {
  const auto* heat = dynamic_cast<const Heat<double>*>(&problem);
  return heat != nullptr ? &heat->options() : nullptr;
}

ProblemRecipe problems::heat(const HeatOptions& options) {
  return problem<Heat>("heat",
                       options,
                       {.unknowns = {"temperature before(i, j)"},
                        .observations = {"temperature(i, j)"}});
}

}  // namespace physinv
