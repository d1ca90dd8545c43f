#include "suite/core/real_fft.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "suite/core/check.h"
#include "suite/core/threads.h"
#include "suite/core/workspace.h"
#include "tests/support/bits.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

template <class T>
class RealFftIn : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(RealFftIn, Scalars);

template <class T>
void fill(Scratch<T> u) {
  u = Batch<T>::NullaryExpr(u.rows(), u.cols(), [](Index j, Index i) {
    return T(0.25 + std::sin(1.7 * double(j) + 0.9 * double(i) + 0.3));
  });
}

TYPED_TEST(RealFftIn, FollowsTheDefinition) {
  using T = TypeParam;
  const Comparator near(0, sizeof(T) == 8 ? 1e-14 : 1e-6);
  for (const Index n : {1, 2, 15, 16, 100, 128, 1024}) {
    for (const Index count : {1, 2, 3}) {
      SCOPED_TRACE(n);
      const RealFft<T> fft(n, count);
      Workspace work;
      auto u = work.take<T>(fft.signal_stride(), count);
      auto back = work.take<T>(fft.signal_stride(), count);
      auto y = work.take<T>(fft.spectrum_stride(), count);
      fill<T>(u);
      const Batch<T> given = u;
      fft.forward(u.data(), y.data());
      EXPECT_TRUE(same_bits(Batch<T>(u), given));
      for (Index i = 0; i < count; ++i) {
        Vector<double> expected(n / 2 * 2 + 2);
        for (Index m = 0; m <= n / 2; ++m) {
          std::complex<double> sum;
          for (Index j = 0; j < n; ++j)
            sum += std::polar(
                double(u(j, i)),
                -2 * std::numbers::pi * double(m * j % n) / double(n));
          expected(2 * m) = sum.real() / double(n);
          expected(2 * m + 1) = sum.imag() / double(n);
        }
        const Vector<T> spectrum = y.col(i).head(expected.size()) / T(n);
        EXPECT_TRUE(near(spectrum, expected));
      }
      fft.inverse(y.data(), back.data());
      EXPECT_TRUE(
          near(Batch<T>(back.topRows(n) / T(n)), Batch<T>(u.topRows(n))));
    }
  }
}

TYPED_TEST(RealFftIn, BitsDependNeitherOnTheArraysNorOnThreads) {
  using T = TypeParam;
  constexpr Index kBlocks = 64;
  Workspace work;
  const RealFft<T> first(128);
  auto u = work.take<T>(first.signal_stride(), kBlocks);
  auto y = work.take<T>(first.spectrum_stride(), kBlocks);
  fill<T>(u);
  u = u.col(0).eval().replicate(1, kBlocks).eval();
  Threads pool(3);
  pool.run(kBlocks, [&](Index i, int) {
    const RealFft<T> fft(128);  // plans are shared
    const RealFft<T> other(32 + 2 * i);
    fft.forward(u.col(i).data(), y.col(i).data());
    fft.inverse(y.col(i).data(), u.col(i).data());
    fft.forward(u.col(i).data(), y.col(i).data());
  });
  for (Index i = 1; i < kBlocks; ++i)
    EXPECT_TRUE(
        same_bits(Batch<T>(y.col(i).head(130)), Batch<T>(y.col(0).head(130))));
}

TYPED_TEST(RealFftIn, ChecksItsContract) {
  using T = TypeParam;
  EXPECT_THROW(RealFft<T>(0), ContractError);
  EXPECT_THROW(RealFft<T>(16, 0), ContractError);
  const RealFft<T> fft(16);
  Workspace work;
  auto u = work.take<T>(64, 1), y = work.take<T>(64, 1);
  EXPECT_THROW(fft.forward(u.data() + 1, y.data()), ContractError);
  EXPECT_THROW(fft.inverse(y.data(), u.data() + 1), ContractError);
}

}  // namespace
}  // namespace physinv::test
