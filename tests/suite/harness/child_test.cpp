#include "suite/harness/child.h"

#include <gtest/gtest.h>

#include "suite/core/clock.h"

namespace physinv {
namespace {

Ended shell(const std::string& script, const ChildLimits& limits = {}) {
  return run_child({"sh", "-c", script}, limits);
}

TEST(Child, StatusAndBothStreams) {
  const Ended ended = shell("echo out; echo err >&2; exit 3");
  EXPECT_EQ(ended.status, 3);
  EXPECT_EQ(ended.output, "out\n");
  EXPECT_EQ(ended.errors, "err\n");
  EXPECT_EQ(ended.exceeded, "");
  EXPECT_EQ(run_child({"/no/such/program"}).status, -1);
  EXPECT_EQ(shell("kill -9 $$").status, 128 + 9);
}

TEST(Child, HasLimits) {
  const double begin = now().wall;
  // The second leaves its output open to one that it does not wait for.
  for (const char* script :
       {"exec sleep 60", "sleep 60 & exit 0", "exec >&- 2>&-; exec sleep 60"}) {
    const Ended slow = shell(script, {.seconds = 0.2});
    EXPECT_EQ(slow.exceeded, "no exit within 0.2 s") << script;
  }
  for (const char* script : {"exec yes", "exec yes >&2"}) {
    const Ended endless = shell(script, {.seconds = 30, .bytes = 100'000});
    EXPECT_EQ(endless.exceeded, "more than 100000 bytes of output");
    EXPECT_LT(endless.output.size() + endless.errors.size(), 110'000U);
    EXPECT_EQ(endless.status, 128 + 9);
  }
  EXPECT_LT(now().wall - begin, 10);
  EXPECT_EQ(shell("head -c 99999 /dev/zero", {.seconds = 30, .bytes = 100'000})
                .output.size(),
            99'999U);
}

}  // namespace
}  // namespace physinv
