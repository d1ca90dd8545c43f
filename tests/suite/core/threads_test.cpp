#include "suite/core/threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <stdexcept>
#include <thread>
#include <vector>

#include "suite/core/check.h"

namespace physinv {
namespace {

class ThreadsTest : public testing::TestWithParam<int> {};

TEST_P(ThreadsTest, RunsEveryBlockOnce) {
  Threads threads(GetParam());
  EXPECT_EQ(threads.count(), GetParam());
  for (const Index blocks : {0, 1, 2, 7, 100, 1000}) {
    std::vector<std::atomic<int>> seen(static_cast<std::size_t>(blocks));
    std::atomic<bool> known{true};
    threads.run(blocks, [&](Index block, int thread) {
      ++seen[static_cast<std::size_t>(block)];
      if (thread < 0 || thread >= GetParam()) known = false;
    });
    for (const auto& s : seen) EXPECT_EQ(s, 1);
    EXPECT_TRUE(known);
  }
}

TEST_P(ThreadsTest, RunsShortJobsOneAfterTheOther) {
  Threads threads(GetParam());
  std::vector<Index> total(8, 0);
  for (Index round = 0; round < 300; ++round) {
    // No atomics: a round must have ended before the next one begins.
    threads.run(8, [&](Index block, int) {
      total[static_cast<std::size_t>(block)] += round;
    });
  }
  for (const Index t : total) EXPECT_EQ(t, 299 * 300 / 2);
}

TEST_P(ThreadsTest, ReturnsWhenAllAreDone) {
  Threads threads(GetParam());
  for (int round = 0; round < 5; ++round) {
    std::atomic<Index> done{0};
    threads.run(2 * GetParam(), [&](Index, int thread) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1 + 2 * thread));
      ++done;
    });
    EXPECT_EQ(done, 2 * GetParam());
  }
}

TEST_P(ThreadsTest, NoTwoBlocksShareAThread) {
  Threads threads(GetParam());
  std::vector<std::atomic<int>> busy(static_cast<std::size_t>(GetParam()));
  std::atomic<bool> shared{false};
  threads.run(500, [&](Index, int thread) {
    auto& mine = busy[static_cast<std::size_t>(thread)];
    if (mine.fetch_add(1) != 0) shared = true;
    mine.fetch_sub(1);
  });
  EXPECT_FALSE(shared);
}

TEST_P(ThreadsTest, RethrowsAndGoesOn) {
  Threads threads(GetParam());
  for (int i = 0; i < 20; ++i) {
    EXPECT_THROW(threads.run(50,
                             [](Index block, int) {
                               if (block % 7 == 3)
                                 throw std::runtime_error("block");
                             }),
                 std::runtime_error);
    std::atomic<Index> sum{0};
    threads.run(10, [&](Index block, int) { sum += block; });
    EXPECT_EQ(sum, 45);
  }
}

TEST_P(ThreadsTest, ForBlocksIsTheSameLoop) {
  Threads threads(GetParam());
  for (Threads* pool : {&threads, static_cast<Threads*>(nullptr)}) {
    std::vector<double> out(33);
    for_blocks(pool, 33, [&](Index b, int) {
      out[static_cast<std::size_t>(b)] = static_cast<double>(b * b);
    });
    for (std::size_t b = 0; b < out.size(); ++b)
      EXPECT_EQ(out[b], static_cast<double>(b * b));
  }
}

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

TEST_P(ThreadsTest, WhoWaitsIsAsleep) {
  Threads threads(GetParam());
  const double begin = cpu_seconds();
  // The caller has nothing left to do long before the others have.
  threads.run(GetParam(), [](Index, int thread) {
    std::this_thread::sleep_for(std::chrono::milliseconds(thread ? 300 : 30));
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_LT(cpu_seconds() - begin, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Counts, ThreadsTest, testing::Values(1, 2, 3, 7));

TEST(Threads, RefusesLessThanOne) {
  EXPECT_THROW(Threads(0), ContractError);
  EXPECT_THROW(Threads(-1), ContractError);
}

}  // namespace
}  // namespace physinv
