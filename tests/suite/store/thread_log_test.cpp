#include "suite/store/thread_log.h"

#include <gtest/gtest.h>

namespace physinv {
namespace {

TEST(ThreadLog, TellsWhatDiffersFromTheUsualNumber) {
  ThreadLog log;
  EXPECT_EQ(changes_text(log, 1), "");
  note_threads(log, 0, 1);
  note_threads(log, 100, 1);
  EXPECT_EQ(changes_text(log, 1), "");
  EXPECT_EQ(changes_text(log, 2), "1 from iteration 0");
  note_threads(log, 340, 2);
  EXPECT_EQ(changes_text(log, 1), "2 from iteration 340");
  note_threads(log, 500, 1);
  EXPECT_EQ(changes_text(log, 1), "2 from iteration 340, 1 from iteration 500");
}

TEST(ThreadLog, WhatRanNoIterationIsNotThere) {
  ThreadLog log{{0, 1}, {7, 4}};
  note_threads(log, 7, 1);
  EXPECT_EQ(log, (ThreadLog{{0, 1}}));
  note_threads(log, 7, 2);
  EXPECT_EQ(log, (ThreadLog{{0, 1}, {7, 2}}));
}

TEST(ThreadLog, IsRecognized) {
  EXPECT_TRUE(is_thread_log({}));
  EXPECT_TRUE(is_thread_log({{0, 1}, {7, 4}}));
  EXPECT_FALSE(is_thread_log({{-1, 1}}));
  EXPECT_FALSE(is_thread_log({{0, 0}}));
  EXPECT_FALSE(is_thread_log({{7, 1}, {7, 2}}));
}

}  // namespace
}  // namespace physinv
