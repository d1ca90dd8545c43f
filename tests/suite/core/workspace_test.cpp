#include "suite/core/workspace.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

#include "suite/core/threads.h"

namespace physinv {
namespace {

bool aligned(const void* p) {
  return reinterpret_cast<std::uintptr_t>(p) % kAlignment == 0;
}

TEST(Buffer, OnlyGrows) {
  Buffer b;
  EXPECT_EQ(b.bytes(), 0U);
  void* first = b.reserve(100);
  EXPECT_TRUE(aligned(first));
  const std::size_t bytes = b.bytes();
  EXPECT_GE(bytes, 100U);
  EXPECT_EQ(b.reserve(1), first);
  EXPECT_EQ(b.bytes(), bytes);
  EXPECT_TRUE(aligned(b.reserve(10 * bytes)));
  EXPECT_GE(b.bytes(), 10 * bytes);
  Buffer none;
  EXPECT_NE(none.reserve(0), nullptr);
}

TEST(Workspace, ArraysAreApartAlignedAndStay) {
  Workspace work;
  const Workspace::Scope scope(work);
  std::vector<Scratch<double>> taken;
  // Sizes that need several chunks; earlier arrays must not move.
  for (Index i = 1; i <= 200; ++i) {
    taken.push_back(work.take<double>(i, 7));
    EXPECT_TRUE(aligned(taken.back().data()));
    taken.back().setConstant(static_cast<double>(i));
  }
  for (Index i = 1; i <= 200; ++i)
    EXPECT_TRUE(
        (taken[static_cast<std::size_t>(i - 1)].array() == double(i)).all());
}

TEST(Workspace, ScopesGiveBack) {
  Workspace work;
  const Workspace::Scope outer(work);
  auto kept = work.take<float>(3, 3);
  kept.setConstant(7);
  const void* place = nullptr;
  {
    const Workspace::Scope inner(work);
    place = work.take<float>(100, 100).data();
  }
  {
    const Workspace::Scope inner(work);
    auto again = work.take<float>(100, 100);
    EXPECT_EQ(again.data(), place);
    again.setZero();
  }
  EXPECT_TRUE((kept.array() == 7).all());
}

TEST(Workspace, HoldsNoMoreTheSecondTime) {
  Workspace work;
  const auto use = [&] {
    const Workspace::Scope outer(work);
    work.take<double>(100, 100);
    for (int i = 0; i < 5; ++i) {
      const Workspace::Scope inner(work);
      work.take<float>(300, 300);
      work.take<char>(1, 1);
    }
    work.take<double>(40, 1);
  };
  use();
  const std::size_t bytes = work.bytes();
  EXPECT_GT(bytes, 0U);
  for (int i = 0; i < 10; ++i) use();
  EXPECT_EQ(work.bytes(), bytes);
}

TEST(Workspace, SettlesToWhatWasInUseAtMost) {
  Workspace work;
  {
    const Workspace::Scope outer(work);
    work.take<std::byte>(1, 1);
    for (int i = 0; i < 10; ++i) {
      const Workspace::Scope inner(work);
      work.take<std::byte>(i * 100'000, 1);
    }
    work.take<std::byte>(300'000, 1);
    EXPECT_GT(work.bytes(), 64U + 900'032U);  // several chunks
  }
  EXPECT_EQ(work.bytes(), 64U + 900'032U);
}

TEST(Workspace, EmptyArraysAreFine) {
  Workspace work;
  const Workspace::Scope scope(work);
  EXPECT_EQ(work.take<double>(0, 5).size(), 0);
  EXPECT_EQ(work.take<double>(5, 0).cols(), 0);
}

TEST(Workspace, ThreadsHaveTheirOwn) {
  Threads threads(3);
  Workspace work(&threads);
  EXPECT_EQ(work.threads(), &threads);
  EXPECT_NE(&work.of_thread(0), &work.of_thread(2));
  EXPECT_EQ(&work.of_thread(1), &work.of_thread(1));
  work.of_thread(1).take<double>(10, 10);
  EXPECT_EQ(work.bytes(), work.of_thread(1).bytes());
  Workspace alone;
  EXPECT_THROW(alone.of_thread(0), ContractError);
}

TEST(Tape, KeepsWhatWasWritten) {
  Tape tape;
  tape.slot<double>(2, 3, 4).setConstant(5);
  tape.slot<int>(0, 2, 2).setConstant(-1);
  EXPECT_TRUE((tape.view<double>(2).array() == 5).all());
  EXPECT_EQ(tape.view<double>(2).rows(), 3);
  EXPECT_EQ(tape.view<double>(2).cols(), 4);
  EXPECT_TRUE((tape.view<int>(0).array() == -1).all());
  EXPECT_THROW(tape.view<double>(3), ContractError);
  // Same size: same contents. Smaller: same memory.
  const std::size_t bytes = tape.bytes();
  EXPECT_TRUE((tape.slot<double>(2, 3, 4).array() == 5).all());
  tape.slot<double>(2, 1, 1);
  EXPECT_EQ(tape.view<double>(2).size(), 1);
  EXPECT_EQ(tape.bytes(), bytes);
}

}  // namespace
}  // namespace physinv
