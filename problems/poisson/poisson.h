/// Poisson's equation on a rectangle of unit cells: which source has a given
/// potential? (Scale-invariant physics training, App. B.2.)
///
///   L y = x,  (L y)_ij = y_{i-1,j} + y_{i+1,j} + y_{i,j-1} + y_{i,j+1} - 4
///   y_ij
///
/// with y = 0 one cell outside. L is symmetric and negative definite, its
/// eigenvectors are products of sines: with S_n orthogonal and symmetric,
/// (S_n)_ik = sqrt(2 / (n + 1)) sin(pi i k / (n + 1)),
///
///   y = S_p ((S_p x S_q) / lambda) S_q,
///   lambda_kl = 2 cos(pi k / (p + 1)) + 2 cos(pi l / (q + 1)) - 4
///
/// Unknown x: the source, cell (i, j) at q i + j (p q). Given: nothing.
/// Observation y: the potential. vjp: exact, the solution is its own adjoint.
/// invert: x = L y, exact; it needs no guess.
///
/// Computed in double, also where T is float. By default the exact solution;
/// with `relative` > 0 conjugate gradients as the authors' code has them, from
/// 0 until |residual| <= relative |x| for each sample by itself.
///
/// What is not finite stays in its own column.
#pragma once

#include "suite/core/linear_problem.h"
#include "suite/core/recipe.h"

namespace physinv {

struct PoissonOptions {
  Index rows = 64, columns = 64;  ///< p, q
  double relative = 0;            ///< 0: the exact solution
  Index most = 1000;              ///< iterations of conjugate gradients

  auto fields() const {
    return std::tuple{field("rows", rows),
                      field("columns", columns),
                      if_changed(field("relative", relative)),
                      if_changed(field("most", most))};
  }
};

/// Smooth random source of zero mean and unit variance (population): the real
/// part of the inverse Fourier transform of c / k^2 for complex noise c = re +
/// i im and k = 10 f, f in cycles per cell, without k^2 <= 0.1.
Batch<double> poisson_source(const Batch<double>& re, const Batch<double>& im);

/// L y of one field, p x q.
Batch<double> laplacian(const Batch<double>& y);

template <class T>
class Poisson : public LinearProblem<T>, public Inverse<T> {
 public:
  using Options = PoissonOptions;
  explicit Poisson(const Options& options = {});

  Shape shape() const override {
    return {
        options_.rows * options_.columns, options_.rows * options_.columns, 0};
  }
  Vector<double> start() const override {
    return Vector<double>::Zero(options_.rows * options_.columns);
  }

  /// x = poisson_source of standard normal noise.
  Samples<double> sample(Index first,
                         Index count,
                         const Rng& rng) const override;

  void forward(BatchIn<T> x,
               BatchIn<T> given,
               BatchOut<T> y,
               Workspace& work) const override;
  /// Keeps which samples are finite.
  void linearize(BatchIn<T> x,
                 BatchIn<T> given,
                 BatchOut<T> y,
                 Tape& tape) const override;
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override;
  void invert(BatchIn<T> y,
              BatchIn<T> given,
              BatchIn<T> x_guess,
              BatchOut<T> x,
              Workspace& work) const override;

  double operations() const override {
    const auto p = static_cast<double>(options_.rows),
               q = static_cast<double>(options_.columns);
    return 4 * p * q * (p + q);
  }

  const Options& options() const { return options_; }
  const Batch<double>& eigenvalues() const { return lambda_; }

 private:
  /// One field, columns x rows as it lies in memory.
  void solve(const Batch<double>& x, Batch<double>& y) const;
  void solve_all(BatchIn<T> x, BatchOut<T> y, Threads* threads) const;

  Options options_;
  Batch<double> along_rows_, along_columns_;  ///< S_p, S_q
  Batch<double> lambda_;                      ///< q x p
};

extern template class Poisson<float>;
extern template class Poisson<double>;

}  // namespace physinv
