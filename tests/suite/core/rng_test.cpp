#include "suite/core/rng.h"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "suite/core/hash.h"

namespace physinv {
namespace {

// Published with Random123 (tests/kat_vectors).
TEST(Philox, KnownAnswers) {
  using P = r123::Philox4x64;
  const std::uint64_t ones = ~0ULL;
  const P::ctr_type zero = P()({{0, 0, 0, 0}}, {{0, 0}});
  EXPECT_EQ(zero[0], 0x16554d9eca36314cULL);
  EXPECT_EQ(zero[1], 0xdb20fe9d672d0fdcULL);
  EXPECT_EQ(zero[2], 0xd7e772cee186176bULL);
  EXPECT_EQ(zero[3], 0x7e68b68aec7ba23bULL);
  const P::ctr_type full = P()({{ones, ones, ones, ones}}, {{ones, ones}});
  EXPECT_EQ(full[0], 0x87b092c3013fe90bULL);
  EXPECT_EQ(full[1], 0x438c3c67be8d0224ULL);
  EXPECT_EQ(full[2], 0x9cc7d7c69cd777b6ULL);
  EXPECT_EQ(full[3], 0xa09caebf594f0ba0ULL);
}

TEST(Stream, IsPhiloxInOrder) {
  const std::uint64_t key = 42;
  Stream s(key);
  for (std::uint64_t block = 0; block < 3; ++block) {
    const auto out =
        r123::Philox4x64()({{block, 0, 0, 0}}, {{key, mix64(~key)}});
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(s.bits(), out[i]);
  }
}

// Data, weights and orders of every campaign depend on these: if one changes,
// so does everything that was ever recorded.
TEST(Stream, KeepsItsBits) {
  Stream s = Rng::root("jpo/billiards", 3).child("data/test").child(7).stream();
  EXPECT_EQ(s.bits(), 0xf9584efa8dfd2b49ULL);
  EXPECT_EQ(s.bits(), 0xfb5a274e58974369ULL);
  EXPECT_EQ(s.uniform(), 0.91890461265667789);
  EXPECT_EQ(s.uniform(-2, 5), 2.2128395301859616);
  EXPECT_EQ(s.uniform(), 0.83875430673761753);
  // Through the mathematics library, so not to the last bit.
  EXPECT_NEAR(s.normal(), 1.3119706883829017, 1e-14);
  EXPECT_NEAR(s.normal(), -0.0042996887843840103, 1e-14);
  EXPECT_NEAR(s.normal(), 0.42266875850772351, 1e-14);
}

struct Moments {
  double mean = 0, variance = 0, skew = 0, kurtosis = 0;
};

template <class Draw>
Moments moments(Draw&& draw, int count) {
  std::vector<double> v(static_cast<std::size_t>(count));
  Moments m;
  for (double& x : v) m.mean += (x = draw()) / count;
  for (const double x : v) {
    const double d = x - m.mean;
    m.variance += d * d / count;
    m.skew += d * d * d / count;
    m.kurtosis += d * d * d * d / count;
  }
  m.skew /= std::pow(m.variance, 1.5);
  m.kurtosis /= m.variance * m.variance;
  return m;
}

// Bounds are five standard errors of 100,000 draws.
TEST(Stream, UniformHasItsMoments) {
  Stream s = Rng::root("moments", 1).stream();
  const Moments m = moments([&] { return s.uniform(); }, 100000);
  EXPECT_NEAR(m.mean, 0.5, 5 * 9.2e-4);
  EXPECT_NEAR(m.variance, 1.0 / 12, 5 * 2.4e-4);
  EXPECT_NEAR(m.skew, 0, 5 * 4e-3);
  EXPECT_NEAR(m.kurtosis, 1.8, 5 * 5e-3);
  for (int i = 0; i < 100000; ++i) {
    const double u = s.uniform();
    ASSERT_TRUE(u >= 0 && u < 1);
    const double v = s.uniform(-3, -1);
    ASSERT_TRUE(v >= -3 && v < -1);
  }
}

TEST(Stream, NormalHasItsMoments) {
  Stream s = Rng::root("moments", 2).stream();
  const Moments m = moments([&] { return s.normal(); }, 100000);
  EXPECT_NEAR(m.mean, 0, 5 * 3.2e-3);
  EXPECT_NEAR(m.variance, 1, 5 * 4.5e-3);
  EXPECT_NEAR(m.skew, 0, 5 * 7.8e-3);
  EXPECT_NEAR(m.kurtosis, 3, 5 * 1.6e-2);
  // The two of a Box-Muller pair do not know each other.
  double product = 0;
  for (int i = 0; i < 50000; ++i) {
    const double first = s.normal();
    product += first * s.normal() / 50000;
  }
  EXPECT_NEAR(product, 0, 5 * 4.5e-3);
}

TEST(Stream, SeveralNormalsAreThoseOfOneByOne) {
  Stream one = Rng::root("several", 0).stream(), several = one;
  for (const Index count : {0, 1, 2, 3, 7, 8, 9, 15, 16, 17, 33, 64, 127}) {
    std::vector<double> some(static_cast<std::size_t>(count));
    several.normals(some.data(), count);
    for (const double value : some) EXPECT_EQ(value, one.normal());
  }
  EXPECT_EQ(several.normal(), one.normal());
}

TEST(Rng, ChildrenDoNotDependOnOrder) {
  const Rng root = Rng::root("tree", 1);
  const std::uint64_t before = root.child("a").child(3).stream().bits();
  root.child("b").stream().bits();
  root.child(3).stream().bits();
  EXPECT_EQ(root.child("a").child(3).stream().bits(), before);
}

TEST(Rng, PlacesAreDistinctAndIndependent) {
  std::set<std::uint64_t> first;
  std::size_t places = 0;
  const auto visit = [&](const Rng& rng) {
    first.insert(rng.stream().bits());
    ++places;
  };
  for (const char* experiment : {"x", "y"}) {
    for (std::uint64_t seed : {0, 1, 2}) {
      const Rng root = Rng::root(experiment, seed);
      visit(root);
      for (const char* name : {"data/test", "data/train", "", "0"}) {
        visit(root.child(name));
        for (std::uint64_t i = 0; i < 100; ++i)
          visit(root.child(name).child(i));
      }
      for (std::uint64_t i = 0; i < 100; ++i) visit(root.child(i));
    }
  }
  EXPECT_EQ(first.size(), places);

  // Neighbours, the closest relatives, are not correlated; nor are the first
  // draws of all of them anything but uniform.
  const Rng data = Rng::root("x", 0).child("data/test");
  double product = 0, mean = 0;
  const int n = 20000;
  for (std::uint64_t i = 0; i < n; ++i) {
    const double a = data.child(i).stream().uniform() - 0.5;
    const double b = data.child(i + 1).stream().uniform() - 0.5;
    product += 12 * a * b / n, mean += a / n;
  }
  EXPECT_NEAR(product, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(mean, 0, 5 * std::sqrt(1.0 / 12 / n));
}

}  // namespace
}  // namespace physinv
