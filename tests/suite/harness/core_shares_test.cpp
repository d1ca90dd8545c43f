#include "suite/harness/core_shares.h"

#include <gtest/gtest.h>

namespace physinv {
namespace {

using Workers = std::vector<std::size_t>;

/// Cases of one thread, with so much work left.
CoreShares sharing(int cores, const std::vector<double>& work) {
  CoreShares shares(cores, 5);
  for (std::size_t w = 0; w < work.size(); ++w) {
    shares.submitted(w, 1);
    shares.started(w, 0);
    shares.set_work_left(w, work[w]);
  }
  return shares;
}

TEST(CoreShares, FreeCoresGoToWhoHasMostLeftPerThread) {
  CoreShares shares = sharing(6, {1, 100, 30});
  EXPECT_EQ(shares.to_ask(10), (Workers{1}));
  EXPECT_EQ(shares.threads_for(1, 10), 4);
  CoreShares more = sharing(8, {1, 100, 60});
  EXPECT_EQ(more.to_ask(10), (Workers{1, 2}));
  EXPECT_EQ(more.threads_for(1, 10), 4);
  EXPECT_EQ(more.threads_for(2, 10), 3);
}

TEST(CoreShares, NobodyIsAskedWithoutCoresTwiceOrTooSoon) {
  EXPECT_TRUE(sharing(3, {1, 2, 3}).to_ask(10).empty());
  EXPECT_TRUE(sharing(2, {1, 2, 3}).to_ask(10).empty());
  CoreShares shares = sharing(2, {1});
  EXPECT_TRUE(shares.to_ask(4).empty());
  EXPECT_EQ(shares.to_ask(5), (Workers{0}));
  EXPECT_TRUE(shares.to_ask(6).empty());
  // A case that went on may be asked again, once it has begun.
  shares.submitted(0, 2);
  EXPECT_TRUE(shares.to_ask(100).empty());
  shares.submitted(0, 1);
  EXPECT_TRUE(shares.to_ask(100).empty());
  shares.started(0, 100);
  EXPECT_EQ(shares.to_ask(105), (Workers{0}));
}

TEST(CoreShares, OthersGetTheShareOfWhoDoesNotLeave) {
  CoreShares shares = sharing(3, {100, 1});
  EXPECT_EQ(shares.to_ask(10), (Workers{0}));
  EXPECT_TRUE(shares.to_ask(20).empty());
  EXPECT_EQ(shares.to_ask(31), (Workers{1}));
  EXPECT_EQ(shares.threads_for(1, 31), 2);
  // It leaves after all.
  shares.submitted(1, 2);
  EXPECT_EQ(shares.threads_for(0, 32), 1);
}

TEST(CoreShares, WhoRunsNoStageKeepsItsThreads) {
  CoreShares shares = sharing(3, {1});
  shares.submitted(1, 1);
  shares.set_work_left(1, 100);
  EXPECT_EQ(shares.to_ask(10), (Workers{0}));
  EXPECT_EQ(shares.threads_for(0, 10), 2);
}

TEST(CoreShares, WhoEndedFreesItsCores) {
  CoreShares shares = sharing(2, {1, 2});
  EXPECT_TRUE(shares.to_ask(10).empty());
  shares.ended(0);
  EXPECT_EQ(shares.to_ask(10), (Workers{1}));
  EXPECT_EQ(shares.threads_for(1, 10), 2);
}

}  // namespace
}  // namespace physinv
