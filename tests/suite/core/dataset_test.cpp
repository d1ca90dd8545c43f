#include "suite/core/dataset.h"

#include <gtest/gtest.h>

#include <cmath>

namespace physinv {
namespace {

Samples<double> samples() {
  return {Batch<double>::Constant(2, 3, 0.1),
          Batch<double>::Constant(4, 3, 0.2),
          Batch<double>::Constant(1, 3, 0.3)};
}

TEST(ContentHash, SeesEveryBitOfEveryPart) {
  const std::uint64_t hash = content_hash(samples());
  EXPECT_EQ(content_hash(samples()), hash);
  for (auto part :
       {&Samples<double>::x, &Samples<double>::y, &Samples<double>::given}) {
    Samples<double> s = samples();
    double& last = (s.*part)((s.*part).size() - 1);
    last = std::nextafter(last, 1.0);
    EXPECT_NE(content_hash(s), hash);
  }
  Samples<double> zero = samples(), minus = samples();
  zero.x(0, 0) = 0.0, minus.x(0, 0) = -0.0;
  EXPECT_NE(content_hash(zero), content_hash(minus));
}

TEST(ContentHash, SeesShapes) {
  Samples<double> s = samples();
  s.x.resize(3, 2), s.x.setConstant(0.1);
  EXPECT_NE(content_hash(s), content_hash(samples()));
  s.x.resize(0, 3);
  const std::uint64_t none = content_hash(s);
  s.x.resize(0, 0);
  EXPECT_NE(content_hash(s), none);
}

TEST(ContentHash, KeepsItsBits) {
  EXPECT_EQ(content_hash(samples()), 0x17e10d4fd2a0e5e9ULL);
}

TEST(Samples, CastRoundsAndKeepsShapes) {
  Samples<double> s = samples();
  s.given.resize(0, 3);
  const Samples<float> f = s.cast<float>();
  EXPECT_EQ(f.count(), 3);
  EXPECT_EQ(f.x(1, 2), 0.1f);
  EXPECT_EQ(f.given.rows(), 0);
  EXPECT_EQ(f.given.cols(), 3);
}

}  // namespace
}  // namespace physinv
