/// Equality to the last bit, NaN included.
#pragma once

#include <gtest/gtest.h>

#include <cstring>

#include "suite/core/batch.h"
#include "suite/results/record.h"

namespace physinv::test {

template <class M>
testing::AssertionResult same_bits(const M& a, const M& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols())
    return testing::AssertionFailure() << "shapes differ";
  for (Index i = 0; i < a.size(); ++i) {
    if (std::memcmp(a.data() + i, b.data() + i, sizeof(a.data()[0])) == 0)
      continue;
    return testing::AssertionFailure()
           << "entry " << i << ": " << a.data()[i] << " and " << b.data()[i];
  }
  return testing::AssertionSuccess();
}

/// Everything of a stage that must not depend on when, where and with how many
/// threads it ran.
inline void expect_same(const StageRecord& a, const StageRecord& b) {
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
    ASSERT_TRUE(b.arrays.contains(name)) << name;
    EXPECT_TRUE(same_bits(array, b.arrays.at(name))) << name;
  }
}

}  // namespace physinv::test
