// Claims of everything registered.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "suite/app/installed.h"
#include "suite/harness/judge.h"
#include "suite/harness/registry.h"

namespace physinv {
namespace {

TEST(ClaimContract, NamesWhatIsRegistered) {
  const auto wrong = registry().problems();
  EXPECT_TRUE(wrong.empty()) << fmt::format("{}", fmt::join(wrong, "\n"));
}

TEST(ClaimContract, NamesWhatThePapersPrint) {
  const Published published(published_directory());
  const auto wrong = registry().unknown_printed(published);
  EXPECT_TRUE(wrong.empty()) << fmt::format("{}", fmt::join(wrong, "\n"));
}

TEST(ClaimContract, NothingIsJudgedFromNothing) {
  const Results nothing;
  const Published published;
  for (const auto& e : registry().experiments()) {
    for (const auto& c : judge(*e, nothing, published))
      EXPECT_EQ(c.verdict, Verdict::not_judged) << e->name << " " << c.id;
  }
}

}  // namespace
}  // namespace physinv
