#include "problems/grid_poisson/grid_poisson.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>

#include "suite/core/check.h"
#include "suite/core/linear_problem.h"
#include "suite/core/math.h"
#include "suite/core/simd/pack.h"
#include "suite/core/threads.h"

namespace physinv {
namespace {

constexpr Index kSide = kPoissonSide, kCells = kPoissonCells;
constexpr Index kBlock = 64;  ///< samples of one unit of work

/// A row of cells, in registers.
template <class T>
struct Row {
  using Half = Pack<T, kSide / 2>;
  Half left, right;

  explicit Row(const T* cells) {
    std::memcpy(&left, cells, sizeof(Half));
    std::memcpy(&right, cells + kSide / 2, sizeof(Half));
  }
};

/// out = L in.
template <class T>
void apply(const T* in, T* out) {
  using Half = typename Row<T>::Half;
  constexpr T kZeros[kSide] = {};
  const Half none = T(-0.0) - Half{};  // added to anything, changes nothing
  Row<T> above(kZeros), row(in);
  for (Index i = 0; i < kSide; ++i) {
    const Row<T> below(i + 1 < kSide ? in + kSide * (i + 1) : kZeros);
    const Half l = row.left, r = row.right;
    const Half middle_left = __builtin_shufflevector(l, r, 1, 2, 3, 4);
    const Half middle_right = __builtin_shufflevector(l, r, 3, 4, 5, 6);
    const Half left = __builtin_shufflevector(none, l, 0, 4, 5, 6);
    const Half right = __builtin_shufflevector(r, none, 1, 2, 3, 4);
    const Half sum[] = {
        ((above.left + below.left) + (left + middle_left)) - T(4) * l,
        ((above.right + below.right) + (middle_right + right)) - T(4) * r};
    std::memcpy(out + kSide * i, sum, sizeof(sum));
    above = row, row = below;
  }
}

/// out = a b of 8 x 8 matrices, columns contiguous. Not Eigen's product, whose
/// bits may depend on the alignment of its operands.
template <class T>
[[gnu::noinline]] void multiply(const T* __restrict a,
                                const T* __restrict b,
                                T* __restrict out) {
  for (Index j = 0; j < kSide; ++j) {
    T sum[kSide] = {};
    for (Index k = 0; k < kSide; ++k) {
      const T factor = b[kSide * j + k];
      for (Index i = 0; i < kSide; ++i) sum[i] += a[kSide * k + i] * factor;
    }
    for (Index i = 0; i < kSide; ++i) out[kSide * j + i] = sum[i];
  }
}

/// 0, or NaN if some entry is not finite: L does not depend on the point, but a
/// derivative taken at such a point must say so.
template <class T>
T poison(const T* x) {
  T sums[kSide] = {};
  for (Index r = 0; r < kCells; r += kSide)
    for (Index k = 0; k < kSide; ++k) sums[k] += T(0) * x[r + k];
  return std::accumulate(sums, sums + kSide, T(0));
}

template <class F>
void for_samples(Threads* threads, Index samples, F&& body) {
  for_blocks(threads, (samples + kBlock - 1) / kBlock, [&](Index b, int) {
    const Index end = std::min(samples, (b + 1) * kBlock);
    for (Index i = b * kBlock; i < end; ++i) body(i);
  });
}

/// fftfreq(8) scaled by 8, squared
double squared_frequency(Index k) {
  const auto f = static_cast<double>(k < kSide / 2 ? k : k - kSide);
  return f * f;
}

/// What each number of the noise adds to the potential, before it is scaled.
Batch<double> waves() {
  double cosine[kSide], sine[kSide];
  for (Index k = 0; k < kSide; ++k) {
    const double angle = 2 * std::numbers::pi * double(k) / kSide;
    cosine[k] = math::cos(angle), sine[k] = math::sin(angle);
  }
  Batch<double> out = Batch<double>::Zero(kCells, 2 * kCells);
  for (Index f = 1; f < kCells; ++f) {
    const Index k = f / kSide, l = f % kSide;
    const double damp = squared_frequency(k) + squared_frequency(l);
    for (Index at = 0; at < kCells; ++at) {
      const Index turn = (k * (at / kSide) + l * (at % kSide)) % kSide;
      out(at, f) = cosine[turn] / damp;
      out(at, kCells + f) = -sine[turn] / damp;
    }
  }
  return out;
}

enum Slot : std::size_t { kPoison };

}  // namespace

Vector<double> poisson_potential(const Vector<double>& noise) {
  SUITE_CHECK(noise.size() == 2 * kCells, "noise must have 64 complex numbers");
  static const Batch<double> kWaves = waves();
  using P = Pack<double>;
  constexpr Index kPacks = kCells / kLanes<double>;
  P sum[kPacks] = {};
  for (Index f = 0; f < 2 * kCells; ++f) {
    const double* const wave = kWaves.col(f).data();
    const double factor = noise(f);
    for (Index i = 0; i < kPacks; ++i)
      sum[i] += factor * load<P>(wave + i * kLanes<double>);
  }
  Vector<double> phi(kCells);
  for (Index i = 0; i < kPacks; ++i)
    store(phi.data() + i * kLanes<double>, sum[i]);
  const double mean = phi.mean();
  const double deviation =
      std::sqrt((phi.array() - mean).square().sum() / kCells);
  if (deviation > 0) phi /= deviation;
  return phi.array() - phi.mean();
}

namespace {

template <class T>
class GridPoisson final : public LinearProblem<T>,
                          public Jacobian<T>,
                          public Inverse<T> {
 public:
  explicit GridPoisson(const GridPoissonOptions&) : matrix_(kCells, kCells) {
    const double turn = std::numbers::pi / (kSide + 1);
    for (Index i = 0; i < kSide; ++i)
      for (Index k = 0; k < kSide; ++k) {
        const auto a = static_cast<double>(i + 1),
                   b = static_cast<double>(k + 1);
        sines_(i, k) =
            T(std::sqrt(2.0 / (kSide + 1)) * math::sin(a * b * turn));
        inverse_eigenvalues_(i, k) =
            T(1 / (-4 + 2 * math::cos(a * turn) + 2 * math::cos(b * turn)));
      }
    const Batch<T> unit = Batch<T>::Identity(kCells, kCells);
    for (Index r = 0; r < kCells; ++r)
      apply(unit.col(r).data(), matrix_.col(r).data());
  }

  Shape shape() const override { return {kCells, kCells, 0}; }
  Vector<double> start() const override { return Vector<double>::Zero(kCells); }

  /// x = poisson_potential of standard normal noise.
  void draw(Stream& stream, SampleOut& sample) const override {
    Vector<double> noise(2 * kCells);
    stream.normals(noise.data(), noise.size());
    sample.x = poisson_potential(noise);
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace& work) const override {
    for_samples(work.threads(), y.cols(), [&](Index i) {
      apply(at.x.col(i).data(), y.col(i).data());
    });
  }
  /// Keeps nothing.
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    auto kept = tape.slot<T>(kPoison, 1, y.cols());
    for_samples(tape.threads(), y.cols(), [&](Index i) {
      kept(0, i) = poison(at.x.col(i).data());
      apply(at.x.col(i).data(), y.col(i).data());
    });
  }
  /// x_bar = L y_bar
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    const auto kept = tape.view<T>(kPoison);
    for_samples(work.threads(), kept.cols(), [&](Index i) {
      apply(y_bar.col(i).data(), x_bar.col(i).data());
      x_bar.col(i).array() += kept(0, i);
    });
  }
  /// The same matrix L for every sample.
  void jacobian(Point<T> at, BatchOut<T> j, Workspace& work) const override {
    for_samples(work.threads(), j.cols(), [&](Index i) {
      j.col(i) = matrix_.reshaped().array() + poison(at.x.col(i).data());
    });
  }
  void invert(Point<T>,
              BatchIn<T> y,
              BatchOut<T> x,
              Workspace& work) const override {
    for_samples(work.threads(), x.cols(), [&](Index i) {
      const T* s = sines_.data();
      Square left, both;
      multiply(s, y.col(i).data(), left.data());
      multiply(left.data(), s, both.data());
      both.array() *= inverse_eigenvalues_.array();
      multiply(s, both.data(), left.data());
      multiply(left.data(), s, both.data());
      x.col(i) = both.reshaped();
    });
  }

  double operations() const override { return 5.0 * kCells; }

 private:
  using Square = Eigen::Matrix<T, kSide, kSide>;
  Square sines_, inverse_eigenvalues_;
  Batch<T> matrix_;  // L
};

}  // namespace

ProblemRecipe problems::grid_poisson(const GridPoissonOptions& options) {
  return problem<GridPoisson>(
      "grid_poisson",
      options,
      {.unknowns = {"potential(i, j)"}, .observations = {"source(i, j)"}});
}

}  // namespace physinv
