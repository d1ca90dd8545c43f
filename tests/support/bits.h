/// Equality to the last bit, NaN included.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>

#include "suite/core/batch.h"
#include "suite/store/record.h"

namespace physinv::test {

/// The first of `count` numbers of so many bytes that differs, -1 if none does.
Index first_difference(const void* a,
                       const void* b,
                       Index count,
                       std::size_t bytes);
testing::AssertionResult shapes_differ();
testing::AssertionResult entry_differs(Index entry, double a, double b);

template <class M>
testing::AssertionResult same_bits(const M& a, const M& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return shapes_differ();
  const Index i =
      first_difference(a.data(), b.data(), a.size(), sizeof(a.data()[0]));
  if (i < 0) return testing::AssertionSuccess();
  return entry_differs(
      i, static_cast<double>(a.data()[i]), static_cast<double>(b.data()[i]));
}

/// Everything of a stage that must not depend on when, where and with how many
/// threads it ran.
void expect_same(const StageRecord& a, const StageRecord& b);

}  // namespace physinv::test
