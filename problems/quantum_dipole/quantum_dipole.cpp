#include "problems/quantum_dipole/quantum_dipole.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <type_traits>

#include "problems/quantum_dipole/cayley.h"
#include "suite/core/check.h"
#include "suite/core/gradient_projection.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"
#include "suite/core/threads.h"

namespace physinv {
namespace {

using quantum::advance;
using quantum::Complex;
using quantum::Constants;
using quantum::factor;
using quantum::kChunk;
using quantum::kPoints;

constexpr Index kRows = 2 * kPoints;
constexpr int kGroups = 2;    ///< registers of samples in a forward pass
constexpr int kRowsOfCs = 2;  ///< rows of cotangents that go back together

template <class T>
using Group = Wide<T, kGroups>;

template <class T>
constexpr Index block_count(Index samples, Index width) {
  return (samples + width - 1) / width;
}

/// All steps of one group, from the ground state.
template <class T>
void propagate(const Constants<T>& k,
               BatchIn<T> x,
               Index first,
               BatchOut<T>& psi_end) {
  static const Vector<double> ground = quantum_eigenstate(1);
  Complex<Group<T>> psi[kPoints];
  const Group<T> zero = Group<T>::make([](int) { return Pack<T>{}; });
  for (int j = 0; j < kPoints; ++j)
    psi[j] = {Group<T>::make([&](int) { return Pack<T>{} + T(ground(j)); }),
              zero};
  for (Index n = 0; n < k.steps; n += kChunk) {
    const Index count = std::min(kChunk, k.steps - n);
    Group<T> u[kChunk];
    Complex<Pack<T>> factors[kChunk * kGroups * kPoints];
    load_rows(x, n, count, first, u);
    factor(k, u->r, static_cast<int>(count) * kGroups, factors);
    for (Index i = 0; i < count; ++i) {
      const auto* e = factors + i * kGroups * kPoints;
      advance(
          k,
          [e](int j) __attribute__((always_inline)) {
            return Complex<Group<T>>{
                Group<T>::make([=](int g) { return e[g * kPoints + j].re; }),
                Group<T>::make([=](int g) { return e[g * kPoints + j].im; })};
          },
          psi,
          [](int, const auto&) {});
    }
  }
  Group<T> rows[kRows];
  for (int j = 0; j < kPoints; ++j)
    rows[2 * j] = psi[j].re, rows[2 * j + 1] = psi[j].im;
  store_rows(rows, psi_end, 0, kRows, first);
}

/// Calls step(n, e) from the last step to the first with the factorisation of
/// each, for one register of samples.
template <class T, class F>
PHYSINV_LANES void backwards(const Constants<T>& k,
                             BatchIn<T> x,
                             Index first,
                             F&& step) {
  for (Index end = k.steps; end > 0;) {
    const Index begin = (end - 1) / kChunk * kChunk;
    Pack<T> u[kChunk];
    Complex<Pack<T>> factors[kChunk * kPoints];
    load_rows(x, begin, end - begin, first, u);
    factor(k, u, static_cast<int>(end - begin), factors);
    for (Index n = end; n-- > begin;) {
      const auto* e = factors + (n - begin) * kPoints;
      step(
          n, [e](int j) __attribute__((always_inline)) { return e[j]; });
    }
    end = begin;
  }
}

/// Gradients of one register of samples. conj(psi) and the row of cotangents
/// share every solve.
template <class T>
[[gnu::noinline]] void pull_block(const Constants<T>& k,
                                  BatchIn<T> x,
                                  BatchIn<T> psi,
                                  BatchIn<T> y_bar,
                                  Index first,
                                  BatchOut<T>& x_bar) {
  using P = Pack<T>;
  using Two = Wide<T, 2>;  // conj(psi), c
  P end[kRows], bar[kRows];
  load_rows(psi, 0, kRows, first, end);
  load_rows(y_bar, 0, kRows, first, bar);
  Complex<Two> c[kPoints];
  for (int j = 0; j < kPoints; ++j) {
    c[j].re = {{end[2 * j], bar[2 * j]}};
    c[j].im = {{-end[2 * j + 1], -bar[2 * j + 1]}};
  }
  P gathered[kChunk];
  backwards(k, x, first, [&](Index n, const auto& e) {
    P even{}, odd{};
    advance(k, e, c, [&](int j, const Complex<Two>& y) {
      P& sum = j % 2 == 0 ? even : odd;
      sum = fma_lanes(k.pull[j],
                      fma_lanes(y.im.r[1], y.re.r[0], -(y.re.r[1] * y.im.r[0])),
                      sum);
    });
    gathered[n % kChunk] = even + odd;
    if (n % kChunk != 0) return;
    store_rows(gathered, 1, x_bar, n, std::min(kChunk, k.steps - n), first);
  });
}

/// Jacobians of one register of samples: 14 unit rows of cotangents.
template <class T>
[[gnu::noinline]] void differentiate_block(const Constants<T>& k,
                                           BatchIn<T> x,
                                           BatchIn<T> psi,
                                           Index first,
                                           BatchOut<T>& jacobian) {
  using P = Pack<T>;
  using Rows = Wide<T, kRowsOfCs>;
  P end[kRows];
  load_rows(psi, 0, kRows, first, end);
  Complex<Wide<T, 1>> back[kPoints];
  for (int j = 0; j < kPoints; ++j)
    back[j] = {{{end[2 * j]}}, {{-end[2 * j + 1]}}};
  constexpr int kBundles = kPoints / kRowsOfCs;
  Complex<Rows> c[kBundles][kPoints];
  for (int b = 0; b < kBundles; ++b)
    for (int j = 0; j < kPoints; ++j)
      c[b][j] = {Rows::make([&](int row) {
                   return P{} + T(b * kRowsOfCs + row == j);
                 }),
                 Rows::make([](int) { return P{}; })};
  backwards(k, x, first, [&](Index n, const auto& e) {
    Complex<P> q[kPoints];  // dt/4 x_j (psi_{n+1} + psi_n)_j / i
    advance(k, e, back, [&](int j, const Complex<Wide<T, 1>>& y) {
      q[j] = {-(k.pull[j] * y.im.r[0]), -(k.pull[j] * y.re.r[0])};
    });
    P column[kRows];
    for (int b = 0; b < kBundles; ++b) {
      const Rows zero = Rows::make([](int) { return P{}; });
      Complex<Rows> sum{zero, zero};
      advance(k, e, c[b], [&](int j, const Complex<Rows>& y) {
        sum = multiply_add(q[j], y, sum);
      });
      for (int row = 0; row < kRowsOfCs; ++row) {
        column[2 * (b * kRowsOfCs + row)] = sum.re.r[row];
        column[2 * (b * kRowsOfCs + row) + 1] = sum.im.r[row];
      }
    }
    store_rows(column, 1, jacobian, kRows * n, kRows, first);
  });
}

/// <a, b> of two states
template <class A, class B>
std::complex<double> inner(const A& a, const B& b) {
  double re = 0, im = 0;
  for (Index j = 0; j < kPoints; ++j) {
    const double ar = a(2 * j), ai = a(2 * j + 1);
    const double br = b(2 * j), bi = b(2 * j + 1);
    re = std::fma(ar, br, std::fma(ai, bi, re));
    im = std::fma(ar, bi, std::fma(-ai, br, im));
  }
  return {re, im};
}

enum Slot : std::size_t { kControls, kEnd };

}  // namespace

Vector<double> quantum_eigenstate(int k) {
  SUITE_CHECK(k >= 1 && k <= kPoints, "an eigenstate must be one of the 14");
  Vector<double> psi(kPoints);
  for (int j = 1; j <= kPoints; ++j)
    psi(j - 1) = math::sin(std::numbers::pi * k * j / (kPoints + 1));
  return psi / std::sqrt(0.5 * (kPoints + 1));
}

double quantum_energy(int k) {
  SUITE_CHECK(k >= 1 && k <= kPoints, "an eigenstate must be one of the 14");
  const double dx = 2.0 / (kPoints + 1);
  const double s = math::sin(std::numbers::pi * k / (2 * (kPoints + 1)));
  return 4 / (dx * dx) * s * s;
}

Vector<double> quantum_observation(const Vector<double>& real_state) {
  SUITE_CHECK(real_state.size() == kPoints, "a state must have 14 points");
  Vector<double> y = Vector<double>::Zero(kRows);
  for (Index j = 0; j < kPoints; ++j) y(2 * j) = real_state(j);
  return y;
}

template <class T>
void quantum_level_loss(int k,
                        BatchIn<T> y,
                        BatchIn<T> target,
                        VectorOut<double> loss) {
  const Vector<double> level = quantum_observation(quantum_eigenstate(k));
  for (Index i = 0; i < y.cols(); ++i) {
    const double miss = math::abs(inner(level, y.col(i))) -
                        math::abs(inner(level, target.col(i)));
    loss(i) = miss * miss;
  }
}

template decltype(quantum_level_loss<float>) quantum_level_loss<float>;
template decltype(quantum_level_loss<double>) quantum_level_loss<double>;

namespace {

template <class T>
class QuantumDipole final : public Problem<T>,
                            public Vjp<T>,
                            public Jacobian<T>,
                            public GradientProjection<T> {
 public:
  explicit QuantumDipole(const QuantumDipoleOptions& options)
      : options_(options) {
    check_numbers<T>({{"dt", options.dt}, {"deviation", options.deviation}});
    check_numbers<double>("angles", options.angles);
    SUITE_CHECK(options.steps > 0 && options.dt > 0,
                "steps and dt must be positive");
    SUITE_CHECK(options.deviation >= 0, "deviation must not be negative");
  }

  Shape shape() const override { return {options_.steps, kRows, 0}; }
  /// Small random controls, always the same; or none (`zero_start`).
  Vector<double> start() const override {
    if (options_.zero_start) return Vector<double>::Zero(options_.steps);
    Stream stream = Rng::root("quantum_dipole/start", 0).stream();
    return Vector<double>::NullaryExpr(options_.steps, [&](Index) {
      return options_.deviation * stream.normal();
    });
  }

  /// Targets f1 psi_2 + f2 psi_3, (f1, f2) uniform on the circle; labelled
  /// samples are random controls.
  void draw(Stream& stream, SampleOut& sample) const override {
    if (sample.labelled) {
      stream.normals(sample.x.data(), options_.steps);
      sample.x *= options_.deviation;
      return;
    }
    const Vector<double> psi2 = quantum_observation(quantum_eigenstate(2));
    const Vector<double> psi3 = quantum_observation(quantum_eigenstate(3));
    double f1 = stream.normal(), f2 = stream.normal();
    if (const auto k = static_cast<std::size_t>(sample.index);
        k < options_.angles.size())
      f1 = math::cos(options_.angles[k]), f2 = math::sin(options_.angles[k]);
    sample.y = (f1 * psi2 + f2 * psi3) / math::hypot(f1, f2);
  }
  Drawn drawn() const override { return Drawn::observations; }

  void forward(Point<T> at, BatchOut<T> y, Workspace& work) const override {
    const auto& x = at.x;
    const Constants<T> k(options_);
    constexpr Index kWidth = Group<T>::kCount;
    for_blocks(work.threads(),
               block_count<T>(x.cols(), kWidth),
               [&](Index b, int) { propagate<T>(k, x, b * kWidth, y); });
  }
  /// Keeps controls and final states; the pullback goes back from there.
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const auto& x = at.x;
    const Constants<T> k(options_);
    constexpr Index kWidth = Group<T>::kCount;
    for_blocks(tape.threads(),
               block_count<T>(x.cols(), kWidth),
               [&](Index b, int) { propagate<T>(k, x, b * kWidth, y); });
    tape.slot<T>(kControls, x.rows(), x.cols()) = x;
    tape.slot<T>(kEnd, kRows, x.cols()) = y;
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    const auto x = tape.view<T>(kControls), psi = tape.view<T>(kEnd);
    const Constants<T> k(options_);
    for_blocks(
        work.threads(), block_count<T>(x.cols(), kLanes<T>), [&](Index b, int) {
          pull_block<T>(k, x, psi, y_bar, b * kLanes<T>, x_bar);
        });
  }
  void jacobian(Point<T> at, BatchOut<T> j, Workspace& work) const override {
    const auto& x = at.x;
    const Constants<double> k(options_);
    constexpr Index kWidth = Group<double>::kCount;
    const auto differentiate =
        [&](BatchIn<double> u, Workspace& own, BatchOut<double> out) {
          auto psi = own.take<double>(kRows, u.cols());
          BatchOut<double> end(psi);
          propagate<double>(k, u, 0, end);
          for (Index i = 0; i < u.cols(); i += kLanes<double>)
            differentiate_block<double>(k, u, psi, i, out);
        };
    Threads* const threads = work.threads();
    if (threads != nullptr) work.of_thread(0);  // makes them all
    const Index blocks = block_count<double>(x.cols(), kWidth);
    for_blocks(threads, blocks, [&](Index b, int thread) {
      Workspace& own = threads != nullptr ? work.of_thread(thread) : work;
      const Workspace::Scope scope(own);
      const Index first = b * kWidth;
      const Index some = std::min(kWidth, x.cols() - first);
      const auto u = x.middleCols(first, some);
      auto out = j.middleCols(first, some);
      if constexpr (std::is_same_v<T, double>) {
        differentiate(u, own, out);
      } else {
        auto wide = own.take<double>(u.rows(), some);
        auto exact = own.take<double>(j.rows(), some);
        // As forward, which gives NaN where the square overflows.
        wide = u.unaryExpr([](T v) {
                  return std::isfinite(v * v) ? v : v * v;
                }).template cast<double>();
        differentiate(wide, own, exact);
        out = exact.template cast<T>();
      }
    });
  }

  void loss(BatchIn<T> y,
            BatchIn<T> target,
            VectorOut<double> loss) const override {
    for (Index i = 0; i < y.cols(); ++i) {
      const auto psi = y.col(i), t = target.col(i);
      const std::complex<double> ip = inner(t, psi);
      loss(i) = 1 - std::norm(ip);
      if (!options_.accurate_loss) continue;
      double rest = 0;
      for (Index j = 0; j < kPoints; ++j) {
        const std::complex<double> at(psi(2 * j), psi(2 * j + 1));
        rest +=
            std::norm(at - ip * std::complex<double>(t(2 * j), t(2 * j + 1)));
      }
      loss(i) = rest;
    }
  }
  /// -2 <t, psi> t
  void loss_gradient(BatchIn<T> y,
                     BatchIn<T> target,
                     BatchOut<T> y_bar) const override {
    for (Index i = 0; i < y.cols(); ++i) {
      const auto t = target.col(i);
      const std::complex<double> ip = inner(t, y.col(i));
      const double a = -2 * ip.real(), b = -2 * ip.imag();
      for (Index j = 0; j < kPoints; ++j) {
        const double re = t(2 * j), im = t(2 * j + 1);
        y_bar(2 * j, i) = T(std::fma(a, re, -(b * im)));
        y_bar(2 * j + 1, i) = T(std::fma(a, im, b * re));
      }
    }
  }

  /// y_bar - psi Re<psi, y_bar>. Once trained, nearly all of the gradient is
  /// that part.
  void project(BatchIn<T> y, BatchOut<T> y_bar) const override {
    for (Index i = 0; i < y.cols(); ++i) {
      double along = 0;
      for (Index r = 0; r < kRows; ++r) along += double(y(r, i)) * y_bar(r, i);
      for (Index r = 0; r < kRows; ++r)
        y_bar(r, i) = T(y_bar(r, i) - along * y(r, i));
    }
  }

  double operations() const override {
    return 480.0 * static_cast<double>(options_.steps);
  }

 private:
  QuantumDipoleOptions options_;
};

}  // namespace

ProblemRecipe problems::quantum_dipole(const QuantumDipoleOptions& options) {
  return problem<QuantumDipole>(
      "quantum_dipole",
      options,
      {.unknowns = {"u(step)"}, .observations = {"psi(point, part)"}});
}

}  // namespace physinv
