#include "suite/core/lanes_fft.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "suite/core/fours_fft.h"
#include "suite/core/real_fft.h"
#include "suite/core/workspace.h"
#include "tests/support/bits.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

template <class T>
class LanesFftIn : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(LanesFftIn, Scalars);

/// Column k: the signal of lane k.
template <class T>
Batch<T> signals(Index size, Index lanes) {
  return Batch<T>::NullaryExpr(size, lanes, [](Index j, Index k) {
    return T(0.25 + std::sin(1.7 * double(j * j) + 0.9 * double(k)));
  });
}

template <class T, int W>
struct Sides {
  using P = Pack<T, W>;
  explicit Sides(Index n) : fft(n), u(n), y(n + 2), back(n) {
    for (Index j = 0; j < n; ++j)
      for (int k = 0; k < W; ++k) u[j][k] = given(j, k);
    fft.forward(u.data(), y.data());
  }
  /// As RealFft has it: of one lane, the modes in ascending order.
  Vector<T> spectrum(int lane) const {
    Vector<T> ordered(fft.spectrum());
    for (Index p = 0; p < fft.spectrum(); ++p)
      ordered(2 * fft.mode(p / 2) + p % 2) = y[p][lane];
    return ordered;
  }

  LanesFft<T> fft;
  Batch<T> given = signals<T>(fft.size(), W);
  std::vector<P> u, y, back;
};

template <class T, int W>
void expect_fftw() {
  for (const Index n : {4, 8, 16, 32, 64, 128, 256, 512, 4096, 32768}) {
    // Of long signals by as much more as they have more passes than 512 points.
    const double more = std::max(1.0, std::log2(double(n)) / 9);
    const Comparator near(0, more * (sizeof(T) == 8 ? 1e-15 : 1e-6));
    SCOPED_TRACE(n);
    Sides<T, W> s(n);
    const RealFft<double> fftw(n);
    Workspace work;
    auto u = work.take<double>(fftw.signal_stride(), 1);
    auto y = work.take<double>(fftw.spectrum_stride(), 1);
    for (int k = 0; k < W; ++k) {
      u.col(0).head(n) = s.given.col(k).template cast<double>();
      fftw.forward(u.data(), y.data());
      EXPECT_TRUE(near(Vector<T>(s.spectrum(k) / T(n)),
                       Vector<double>(y.col(0).head(n + 2) / double(n))));
    }
    s.fft.inverse(s.y.data(), s.back.data());
    for (int k = 0; k < W; ++k) {
      Vector<T> back(n);
      for (Index j = 0; j < n; ++j) back(j) = s.back[j][k] / T(n);
      EXPECT_TRUE(
          near(back, Vector<double>(s.given.col(k).template cast<double>())));
    }
  }
}

TYPED_TEST(LanesFftIn, AgreesWithFftwAndGoesBack) {
  expect_fftw<TypeParam, kLanes<TypeParam>>();
  expect_fftw<TypeParam, 16 / sizeof(TypeParam)>();
}

TYPED_TEST(LanesFftIn, HasTheBitsOfAnyWidth) {
  using T = TypeParam;
  constexpr int kFew = 16 / sizeof(T);
  Sides<T, kLanes<T>> wide(128);
  Sides<T, kFew> narrow(128);
  for (int k = 0; k < kFew; ++k)
    EXPECT_EQ(wide.spectrum(k), narrow.spectrum(k));
  wide.fft.inverse(wide.y.data(), wide.back.data());
  narrow.fft.inverse(narrow.y.data(), narrow.back.data());
  for (Index j = 0; j < 128; ++j)
    for (int k = 0; k < kFew; ++k)
      EXPECT_EQ(wide.back[j][k], narrow.back[j][k]);
}

/// W / 4 signals, by FoursFft and by LanesFft.
template <class T, int W>
void expect_bits_of_lanes(const Batch<T>& given) {
  constexpr int kFew = 16 / sizeof(T);
  const Index n = given.rows();
  const FoursFft<T> fours(n);
  const LanesFft<T> lanes(n);
  std::vector<Pack<T, W>> u(fours.field()), y(fours.spectrum()), back(u.size());
  std::vector<Pack<T, kFew>> lane_u(n), lane_y(n + 2), lane_back(n);
  const auto at = [](auto& packs, Index place, Index k) -> auto& {
    return reinterpret_cast<T*>(&packs[place / 4])[4 * k + place % 4];
  };
  for (Index j = 0; j < n; ++j)
    for (Index k = 0; k < W / 4; ++k)
      at(u, fours.point(j), k) = lane_u[j][k] = given(j, k);
  fours.forward(u.data(), y.data());
  lanes.forward(lane_u.data(), lane_y.data());
  Batch<T> ours(n + 2, W / 4), theirs(n + 2, W / 4);
  for (Index i = 0; i < n + 2; ++i)
    for (Index k = 0; k < W / 4; ++k) {
      ours(i, k) = at(y, fours.place(i), k);
      EXPECT_EQ(ours(i, k), fours.taken(y.data(), fours.place(i))[4 * k]);
      theirs(i, k) = lane_y[i][k];
    }
  EXPECT_TRUE(same_bits(ours, theirs));
  fours.inverse(y.data(), back.data());
  lanes.inverse(lane_y.data(), lane_back.data());
  for (Index j = 0; j < n; ++j)
    for (Index k = 0; k < W / 4; ++k) {
      ours(j, k) = at(back, fours.point(j), k);
      theirs(j, k) = lane_back[j][k];
    }
  EXPECT_TRUE(same_bits(ours, theirs));
}

TYPED_TEST(LanesFftIn, FourPointsSideBySideHaveTheBitsOfLanes) {
  using T = TypeParam;
  for (const Index n : {32, 128, 512, 2048}) {
    SCOPED_TRACE(n);
    ASSERT_TRUE(FoursFft<T>::takes(n));
    Batch<T> given = signals<T>(n, 4);
    expect_bits_of_lanes<T, 4>(given);
    expect_bits_of_lanes<T, kLanes<T>>(given);
    // Signs of zeros, too.
    given.setConstant(T(-0.0)), given(n / 4 + 1, 0) = 1;
    expect_bits_of_lanes<T, 4>(given);
    expect_bits_of_lanes<T, kLanes<T>>(given);
  }
  for (const Index n : {8, 16, 64, 96, 256})
    EXPECT_FALSE(FoursFft<T>::takes(n)) << n;
  EXPECT_THROW(FoursFft<T>(64), std::exception);
}

TEST(LanesFft, WantsAPowerOfTwo) {
  EXPECT_THROW(LanesFft<double>(2), std::exception);
  EXPECT_THROW(LanesFft<double>(48), std::exception);
}

}  // namespace
}  // namespace physinv::test
