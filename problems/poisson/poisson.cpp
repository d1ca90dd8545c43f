#include "problems/poisson/poisson.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "suite/core/check.h"
#include "suite/core/eigen_caches.h"
#include "suite/core/linear_problem.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"
#include "suite/core/threads.h"
#include "suite/core/unit_of.h"
#include "suite/linalg/tile_product.h"

namespace physinv {
namespace {

enum Slot : std::size_t { kFinite };

Batch<double> sines(Index n) {
  const auto steps = static_cast<double>(n + 1);
  return std::sqrt(2 / steps) *
         Batch<double>::NullaryExpr(n, n, [=](Index i, Index k) {
           const auto turn =
               static_cast<double>((i + 1) * (k + 1) % (2 * n + 2));
           return math::sin(std::numbers::pi * turn / steps);
         });
}

/// Of the same columns, with further rows that hold `fill`.
Batch<double> with_padded_rows(const Batch<double>& a, double fill) {
  Batch<double> out = Batch<double>::Constant(
      round_up(a.rows(), linalg::kTileColumns), a.cols(), fill);
  out.topRows(a.rows()) = a;
  return out;
}

/// to = a b, whose sums run in the order of a's columns. The rows of a and `to`
/// are as many as fill tiles; b's columns are `b_rows` numbers apart.
void multiply(const Batch<double>& a,
              const double* b,
              Index b_rows,
              Batch<double>& to) {
  linalg::multiply<linalg::Into::set>(to.cols(),
                                      to.rows(),
                                      a.cols(),
                                      {b, b_rows, 1},
                                      a.data(),
                                      a.rows(),
                                      to.data(),
                                      to.rows());
}

double eigenvalue(Index k, Index n) {
  return 2 * math::cos(std::numbers::pi * static_cast<double>(k + 1) /
                       static_cast<double>(n + 1)) -
         2;
}

/// Frequencies in cycles per cell, the negative ones in the upper half.
double frequency(Index k, Index n) {
  return static_cast<double>(2 * k < n ? k : k - n) / static_cast<double>(n);
}

/// exp(2 pi i j k / n), real and imaginary parts.
struct Waves {
  explicit Waves(Index n) : cosine(n, n), sine(n, n) {
    for (Index k = 0; k < n; ++k)
      for (Index j = 0; j < n; ++j) {
        const auto [s, c] =
            math::sincos(2 * std::numbers::pi * static_cast<double>(j * k % n) /
                         static_cast<double>(n));
        cosine(j, k) = c, sine(j, k) = s;
      }
  }
  Batch<double> cosine, sine;
};

/// Conjugate gradients on L y = x from 0, fields as they lie in memory.
void iterate(const PoissonOptions& o,
             const Batch<double>& x,
             Batch<double>& y) {
  if (const double unit = unit_of(x.cwiseAbs().maxCoeff()); unit != 1) {
    iterate(o, x / unit, y);
    y *= unit;
    return;
  }
  y.setZero(x.rows(), x.cols());
  Batch<double> r = x, p = x, lp;
  const double enough = o.relative * o.relative * x.squaredNorm();
  double rr = r.squaredNorm();
  for (Index k = 0; k < o.most && rr > enough; ++k) {
    lp = laplacian(p);
    const double alpha = rr / p.cwiseProduct(lp).sum();
    y += alpha * p;
    r -= alpha * lp;
    const double next = r.squaredNorm();
    p = r + next / rr * p;
    rr = next;
  }
  if (!std::isfinite(rr)) y.setConstant(std::nan(""));
}

const PoissonOptions& checked(const PoissonOptions& o) {
  check_numbers<double>({{"relative", o.relative}});
  SUITE_CHECK(o.rows > 0 && o.columns > 0 && o.relative >= 0,
              "a rectangle must have cells, a tolerance must not be negative");
  SUITE_CHECK(o.most > 0, "conjugate gradients need at least one iteration");
  return o;
}

}  // namespace

Batch<double> poisson_source(const Batch<double>& re, const Batch<double>& im) {
  const Index p = re.rows(), q = re.cols();
  Batch<double> a(p, q), b(p, q);  // amplitudes a + i b
  for (Index l = 0; l < q; ++l) {
    for (Index k = 0; k < p; ++k) {
      const double u = 10 * frequency(k, p), v = 10 * frequency(l, q);
      const double square = u * u + v * v;
      const bool mean = square <= 0.1;
      a(k, l) = mean ? 0 : re(k, l) / square;
      b(k, l) = mean ? 0 : im(k, l) / square;
    }
  }
  state_caches();
  const Waves left(p), right(q);
  const Batch<double> half = left.cosine * a - left.sine * b;
  const Batch<double> turned = left.cosine * b + left.sine * a;
  Batch<double> x = half * right.cosine - turned * right.sine;
  const double mean = x.mean();
  x /= std::sqrt((x.array() - mean).square().mean());
  x.array() -= x.mean();
  return x;
}

Batch<double> poisson_eigenvalues(Index rows, Index columns) {
  return Batch<double>::NullaryExpr(columns, rows, [&](Index l, Index k) {
    return eigenvalue(k, rows) + eigenvalue(l, columns);
  });
}

Batch<double> laplacian(const Batch<double>& y) {
  const Index p = y.rows(), q = y.cols();
  Batch<double> out = -4 * y;
  out.topRows(p - 1) += y.bottomRows(p - 1);
  out.bottomRows(p - 1) += y.topRows(p - 1);
  out.leftCols(q - 1) += y.rightCols(q - 1);
  out.rightCols(q - 1) += y.leftCols(q - 1);
  return out;
}

namespace {

template <class T>
class Poisson final : public LinearProblem<T>, public Inverse<T> {
 public:
  explicit Poisson(const PoissonOptions& options)
      : options_(checked(options)),
        along_rows_(sines(options.rows)),
        along_columns_(with_padded_rows(sines(options.columns), 0)),
        lambda_(with_padded_rows(
            poisson_eigenvalues(options.rows, options.columns), 1)) {}

  Shape shape() const override {
    const Index cells = options_.rows * options_.columns;
    return {cells, cells, 0};
  }
  Vector<double> start() const override {
    return Vector<double>::Zero(options_.rows * options_.columns);
  }

  /// x = poisson_source of standard normal noise.
  void draw(Stream& stream, SampleOut& sample) const override {
    const Index p = options_.rows, q = options_.columns;
    Batch<double> re(p, q), im(p, q);
    Vector<double> pairs(2 * p * q);
    stream.normals(pairs.data(), pairs.size());
    for (Index k = 0, at = 0; k < p; ++k)
      for (Index l = 0; l < q; ++l, at += 2)
        re(k, l) = pairs(at), im(k, l) = pairs(at + 1);
    const Batch<double> x = poisson_source(re, im).transpose();
    sample.x = x.reshaped();
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace& work) const override {
    solve_all(at.x, y, work.threads());
  }
  /// Keeps which samples are finite.
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    auto finite = tape.slot<T>(kFinite, 1, y.cols());
    for (Index i = 0; i < y.cols(); ++i)
      finite(0, i) = at.x.col(i).allFinite() ? T(1) : T(0);
    solve_all(at.x, y, tape.threads());
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    solve_all(y_bar, x_bar, work.threads());
    const auto finite = tape.view<T>(kFinite);
    for (Index i = 0; i < finite.cols(); ++i)
      if (finite(0, i) == T(0))
        x_bar.col(i).setConstant(std::numeric_limits<T>::quiet_NaN());
  }
  void invert(Point<T>,
              BatchIn<T> y,
              BatchOut<T> x,
              Workspace& work) const override {
    const Index p = options_.rows, q = options_.columns;
    for_blocks(work.threads(), y.cols(), [&](Index i, int) {
      const Batch<double> field =
          Eigen::Map<const Batch<T>>(y.col(i).data(), q, p)
              .template cast<double>();
      x.col(i) = laplacian(field).reshaped().template cast<T>();
    });
  }

  double operations() const override {
    const auto p = static_cast<double>(options_.rows),
               q = static_cast<double>(options_.columns);
    return 4 * p * q * (p + q);
  }

 private:
  /// Fields, columns x rows as they lie in memory, with padded rows.
  struct Fields {
    Batch<double> in, one, two;
  };

  /// fields.two = the potential of fields.in, whose rows are not padded.
  void solve(Fields& fields) const {
    auto& [in, one, two] = fields;
    if (options_.relative > 0) return iterate(options_, in, two);
    const Index p = options_.rows;
    one.resize(lambda_.rows(), p), two.resize(lambda_.rows(), p);
    multiply(along_columns_, in.data(), in.rows(), one);
    multiply(one, along_rows_.data(), p, two);
    two.array() /= lambda_.array();
    multiply(along_columns_, two.data(), two.rows(), one);
    multiply(one, along_rows_.data(), p, two);
  }
  void solve_all(BatchIn<T> x, BatchOut<T> y, Threads* threads) const {
    const Index p = options_.rows, q = options_.columns;
    std::vector<Fields> fields(
        static_cast<std::size_t>(threads == nullptr ? 1 : threads->count()));
    for_blocks(threads, x.cols(), [&](Index i, int thread) {
      Fields& own = fields[static_cast<std::size_t>(thread)];
      own.in = Eigen::Map<const Batch<T>>(x.col(i).data(), q, p)
                   .template cast<double>();
      solve(own);
      Eigen::Map<Batch<T>>(y.col(i).data(), q, p) =
          own.two.topRows(q).template cast<T>();
    });
  }

  PoissonOptions options_;
  Batch<double> along_rows_;              ///< S_p
  Batch<double> along_columns_, lambda_;  ///< S_q and q x p, padded rows
};

}  // namespace

ProblemRecipe problems::poisson(const PoissonOptions& options) {
  return problem<Poisson>(
      "poisson",
      options,
      {.unknowns = {"source(i, j)"}, .observations = {"potential(i, j)"}});
}

}  // namespace physinv
