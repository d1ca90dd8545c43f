// Mistakes in claims.md are the user's: one line that names the place.
#include <gtest/gtest.h>

#include <string>

#include "suite/cases/common/claims.h"
#include "suite/harness/errors.h"

namespace physinv {
namespace {

std::string said_of(const char* folder) {
  try {
    claims_of_folder(folder);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(ClaimsOfFolder, AnUnknownNameIsToldWithItsPlace) {
  // Without the names that the experiment defines.
  const std::string said = said_of("jpo/billiards");
  EXPECT_EQ(said.rfind("suite/cases/jpo/billiards/claims.md:", 0), 0U) << said;
  EXPECT_EQ(said.find('\n'), said.npos) << said;
}

TEST(ClaimsOfFolder, AMissingDocumentIsNamed) {
  const std::string said = said_of("jpo/gone");
  EXPECT_EQ(said.rfind("there is no suite/cases/jpo/gone/claims.md", 0), 0U)
      << said;
}

}  // namespace
}  // namespace physinv
