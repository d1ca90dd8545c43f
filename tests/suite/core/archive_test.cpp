// Bytes in, the same state out.

#include "suite/core/archive.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "tests/support/bits.h"

namespace physinv::test {
namespace {

struct Inner {
  std::vector<double> values;
  bool on = false;
  void serialize(Archive& archive) { archive(values, on); }
};

struct Outer {
  Batch<float> matrix;
  Vector<double> vector;
  std::vector<Inner> parts;
  long count = 0;
  void serialize(Archive& archive) { archive(matrix, vector, parts, count); }
};

Outer example() {
  Outer o;
  o.matrix.setRandom(3, 5);
  o.matrix(1, 2) = std::numeric_limits<float>::quiet_NaN();
  o.vector.setRandom(7);
  o.parts = {{{1, 2, 3}, true}, {}};
  o.count = -4;
  return o;
}

TEST(Archive, GivesBackWhatItCollected) {
  Outer from = example();
  Archive collected;
  collected(from);
  EXPECT_FALSE(collected.reading());

  Outer to;
  to.vector.setOnes(7);
  Archive archive(collected.bytes());
  EXPECT_TRUE(archive.reading());
  EXPECT_FALSE(archive.at_end());
  archive(to);
  EXPECT_TRUE(archive.at_end());
  EXPECT_TRUE(same_bits(from.matrix, to.matrix));
  EXPECT_TRUE(same_bits(from.vector, to.vector));
  ASSERT_EQ(to.parts.size(), 2U);
  EXPECT_EQ(to.parts[0].values, from.parts[0].values);
  EXPECT_TRUE(to.parts[0].on);
  EXPECT_TRUE(to.parts[1].values.empty());
  EXPECT_EQ(to.count, -4);
}

TEST(Archive, EmptyMatricesKeepTheirShapes) {
  Batch<double> from(4, 0), to;
  Archive collected;
  collected(from);
  Archive(collected.bytes())(to);
  EXPECT_EQ(to.rows(), 4);
  EXPECT_EQ(to.cols(), 0);
}

TEST(Archive, WhatHasAShapeKeepsIt) {
  Batch<double> from = Batch<double>::Ones(3, 5);
  Archive collected;
  collected(from);
  const auto into = [&](Index rows, Index cols) {
    Batch<double> to = Batch<double>::Zero(rows, cols);
    Archive(collected.bytes())(to);
    return to == from;
  };
  EXPECT_TRUE(into(3, 5));
  EXPECT_TRUE(into(3, 0)) << "columns may come";
  EXPECT_TRUE(into(0, 0));
  EXPECT_THROW(into(4, 0), ContractError);
  EXPECT_THROW(into(3, 4), ContractError);
  EXPECT_THROW(into(5, 3), ContractError);
}

TEST(Archive, ABoolIsTrueOrFalse) {
  for (const char byte : {0, 1, 2, -1}) {
    Archive archive(std::string(1, byte));
    bool on = false;
    if (byte == 0 || byte == 1) {
      archive(on);
      EXPECT_EQ(on, byte == 1);
    } else {
      EXPECT_THROW(archive(on), ContractError);
    }
  }
}

TEST(Archive, RefusesAStateThatIsTooShort) {
  Outer from = example();
  Archive collected;
  collected(from);
  Archive archive(collected.bytes().substr(0, collected.bytes().size() - 1));
  Outer to;
  EXPECT_THROW(archive(to), std::logic_error);
}

/// A size is only a claim: nothing is made for what is not there.
TEST(Archive, RefusesSizesThatCannotBe) {
  Outer from = example();
  Archive collected;
  collected(from);
  const std::string& bytes = collected.bytes();
  for (std::size_t at = 0; at + 8 <= bytes.size(); ++at) {
    for (const std::int64_t size : {std::int64_t{-1},
                                    std::int64_t{1} << 30,
                                    std::int64_t{1} << 60,
                                    std::numeric_limits<std::int64_t>::max(),
                                    std::numeric_limits<std::int64_t>::min()}) {
      auto wrong = bytes;
      std::memcpy(wrong.data() + at, &size, 8);
      Archive archive(wrong);
      Outer to;
      try {
        archive(to);  // a number, not a size
      } catch (const std::logic_error&) {
      }
    }
  }
}

}  // namespace
}  // namespace physinv::test
