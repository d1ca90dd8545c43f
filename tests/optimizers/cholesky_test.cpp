#include "suite/linalg/cholesky.h"

#include <gtest/gtest.h>

#include <limits>

#include "suite/core/rng.h"

namespace physinv::linalg {
namespace {

/// A symmetric matrix as the kernels want it, and as Eigen does.
struct Definite {
  explicit Definite(Index n) : a(n, n), memory(std::size_t(n * stride(n))) {
    Stream stream = Rng::root("cholesky", std::uint64_t(n)).stream();
    Batch<double> b(n, n);
    for (double& v : b.reshaped()) v = stream.uniform(-1, 1);
    a = b * b.transpose() + 0.1 * Batch<double>::Identity(n, n);
    for (Index r = 0; r < n; ++r)
      for (Index c = r; c < n; ++c) padded().row(r)[c] = a(r, c);
  }
  static Index stride(Index n) { return padded_stride(n); }
  Symmetric padded() { return {memory.data(), a.rows(), stride(a.rows())}; }

  Batch<double> a;
  std::vector<double> memory;
};

TEST(Cholesky, FactorsAndSolvesMatricesOfEverySize) {
  for (const Index n : {1, 2, 7, 8, 9, 16, 17, 63, 64, 65, 80, 129, 200}) {
    Definite m(n);
    ASSERT_TRUE(cholesky(m.padded())) << n;
    Batch<double> l = Batch<double>::Zero(n, n);
    for (Index k = 0; k < n; ++k)
      for (Index i = k; i < n; ++i) l(i, k) = m.padded().row(k)[i];
    EXPECT_LT((l * l.transpose() - m.a).norm(), 1e-14 * m.a.norm()) << n;

    std::vector<double> b(m.padded().stride, 0), x(b.size());
    for (Index i = 0; i < n; ++i) b[std::size_t(i)] = double(i % 5) - 1;
    const Vector<double> wanted = Eigen::Map<Vector<double>>(b.data(), n);
    cholesky_solve(m.padded(), b.data(), x.data());
    const Vector<double> found = Eigen::Map<Vector<double>>(x.data(), n);
    EXPECT_LT((m.a * found - wanted).norm(), 1e-14 * m.a.norm() * found.norm())
        << n;
  }
}

TEST(Cholesky, RefusesWhatIsNotDefinite) {
  for (const Index n : {1, 20, 100})
    for (const double last : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
      Definite m(n);
      m.padded().row(n - 1)[n - 1] = last;
      EXPECT_FALSE(cholesky(m.padded()));
    }
}

}  // namespace
}  // namespace physinv::linalg
