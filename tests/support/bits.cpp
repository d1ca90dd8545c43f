#include "tests/support/bits.h"

#include <cstring>

namespace physinv::test {

Index first_difference(const void* a,
                       const void* b,
                       Index count,
                       std::size_t bytes) {
  const auto *p = static_cast<const char*>(a), *q = static_cast<const char*>(b);
  for (Index i = 0; i < count; ++i, p += bytes, q += bytes)
    if (std::memcmp(p, q, bytes) != 0) return i;
  return -1;
}

testing::AssertionResult shapes_differ() {
  return testing::AssertionFailure() << "shapes differ";
}

testing::AssertionResult entry_differs(Index entry, double a, double b) {
  return testing::AssertionFailure()
         << "entry " << entry << ": " << a << " and " << b;
}

void expect_same(const StageRecord& a, const StageRecord& b) {
  SCOPED_TRACE(a.case_name + " " + a.stage);
  EXPECT_EQ(a.case_name, b.case_name);
  EXPECT_EQ(a.stage, b.stage);
  EXPECT_EQ(a.key, b.key);
  EXPECT_EQ(a.trajectory, b.trajectory);
  EXPECT_EQ(a.stop, b.stop);
  EXPECT_EQ(a.message, b.message);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.counts, b.counts);
  EXPECT_EQ(a.status, b.status);
  EXPECT_TRUE(same_bits(a.x, b.x));
  EXPECT_TRUE(same_bits(a.loss, b.loss));
  EXPECT_TRUE(same_bits(a.example_iterations, b.example_iterations));
  EXPECT_TRUE(same_bits(a.example_evaluations, b.example_evaluations));
  EXPECT_EQ(a.curve.iteration, b.curve.iteration);
  EXPECT_EQ(a.curve.evaluations, b.curve.evaluations);
  EXPECT_TRUE(same_bits(a.curve.loss, b.curve.loss));
  EXPECT_TRUE(same_bits(a.curve.x, b.curve.x));
  ASSERT_EQ(a.arrays.size(), b.arrays.size());
  for (const auto& [name, array] : a.arrays) {
    const auto key = ArrayKey::own(name);
    ASSERT_TRUE(b.arrays.contains(key)) << name;
    EXPECT_TRUE(same_bits(array, b.arrays.at(key))) << name;
  }
}

}  // namespace physinv::test
