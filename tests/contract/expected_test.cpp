// The reviewed list of expected failures names claims that exist.
#include "suite/harness/expected.h"

#include <gtest/gtest.h>

namespace physinv::test {
namespace {

TEST(ExpectedFailures, NameClaims) {
  const std::filesystem::path path =
      PHYSINV_SOURCE_DIR "/reports/expected_failures.json";
  const auto expected = read_expected(path);
  EXPECT_FALSE(expected.empty());
  EXPECT_NO_THROW(check_expected(expected, registry(), {}, path));
}

}  // namespace
}  // namespace physinv::test
