// The reduction to tridiagonal form and the rotations behind it.
#include <gtest/gtest.h>

#include "optimizers/half_inverse/spectral_power.h"
#include "suite/core/threads.h"
#include "tests/optimizers/half_inverse_truth.h"

namespace physinv::hig {

using namespace linalg;

namespace {

TEST(Tridiagonalize, SimilarAndLeavesTheFirstCoordinate) {
  for (const Index n : {1, 2, 3, 5, 17, 32, 33, 34, 40, 64, 65, 97, 130, 257})
    for (const Stages stages : {Stages::one, Stages::two}) {
      const Batch<double> j = noise(n, n, 110);
      const Batch<double> a = j + j.transpose();
      Tridiagonalize t;
      const Symmetric s = t.matrix(n);
      for (Index c = 0; c < n; ++c)
        for (Index r = c; r < n; ++r) s.row(c)[r] = a(r, c);
      t.reduce(stages);
      Batch<double> q = Batch<double>::Identity(n, n);
      for (Index i = 0; i < n; ++i) t.apply(q.col(i).data());
      Batch<double> d = t.diagonal().asDiagonal();
      for (Index i = 0; i + 1 < n; ++i)
        d(i, i + 1) = d(i + 1, i) = t.off_diagonal()(i);
      EXPECT_LT((q * d * q.transpose() - a).norm(), 1e-14 * a.norm() * 5);
      EXPECT_LT((q.transpose() * q - Batch<double>::Identity(n, n)).norm(),
                1e-13);
      EXPECT_TRUE(q.col(0) == (Vector<double>::Unit(n, 0)));
    }
}

TEST(TridiagonalQr, RotationsForwardsAndBackwards) {
  for (const Index n : {1, 2, 3, 50, 300}) {
    Vector<double> d = noise(n, 1, 120), e = noise(n, 1, 121).topRows(n - 1);
    Batch<double> t = d.asDiagonal();
    for (Index i = 0; i + 1 < n; ++i) t(i, i + 1) = t(i + 1, i) = e(i);
    Vector<double> x = noise(n, 1, 122);
    const Vector<double> start = x;
    TridiagonalQr qr;
    ASSERT_TRUE(qr.run(d, e, x));
    EXPECT_LT(qr.sweeps(), 5 * n);
    Vector<double> back = x;
    qr.apply(back.data());
    EXPECT_LT((back - start).norm(), 1e-13 * start.norm() * 5);
    back = d.cwiseProduct(x);  // T start = W lambda W^T start
    qr.apply(back.data());
    EXPECT_LT((back - t * start).norm(), 1e-12 * (t * start).norm());
  }
}

TEST(HalfInverse, BitsDoNotDependOnThreads) {
  for (const Index m : {70, 420, 600}) {
    const Batch<double> j = noise(m, m / 2, 100);
    const Batch<double> gram = j * j.transpose();
    const Vector<double> g = noise(m, 1, 101);
    for (const Stages stages : {Stages::one, Stages::two}) {
      Vector<double> serial(m), v(m);
      SpectralPower one;
      ASSERT_EQ(one.factor(gram, g, 1, stages), Ending::ok);
      one.apply({.tau = 1e-4}, serial);
      for (const int count : {2, 3}) {
        Threads threads(count);
        SpectralPower several(&threads);
        ASSERT_EQ(several.factor(gram, g, 1, stages), Ending::ok);
        several.apply({.tau = 1e-4}, v);
        EXPECT_TRUE(v == serial) << m << " " << count;
      }
      // A second matrix of another size leaves no traces in the scratch.
      Vector<double> small(2);
      ASSERT_EQ(one.factor(gram.topLeftCorner(2, 2), g.head(2), 1, stages),
                Ending::ok);
      one.apply({}, small);
      ASSERT_EQ(one.factor(gram, g, 1, stages), Ending::ok);
      one.apply({.tau = 1e-4}, v);
      EXPECT_TRUE(v == serial);
    }
  }
}

}  // namespace
}  // namespace physinv::hig
