#include "suite/harness/columns.h"

#include <gtest/gtest.h>

#include <sstream>

#include "suite/results/shortened.h"

namespace physinv {
namespace {

std::size_t characters(const std::string& text) {
  std::size_t count = 0;
  for (const char c : text)
    count += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1 : 0;
  return count;
}

Columns example() {
  Columns table({"<case", "<stages", "operations"});
  table.add({"hig/poisson/long-adam-hig/n=1024/seed=4", "adam hig", "2.8e+12"});
  table.add({"sip/é", "fit", "1"});
  return table;
}

TEST(Columns, StandAligned) {
  EXPECT_EQ(example().text(std::string::npos),
            "case                                     stages    operations\n"
            "hig/poisson/long-adam-hig/n=1024/seed=4  adam hig     2.8e+12\n"
            "sip/é                                    fit                1\n");
}

TEST(Columns, FitAnyRoom) {
  for (const std::size_t room : {10, 20, 40, 60, 80, 120}) {
    std::istringstream lines(example().text(room));
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line); ++count)
      EXPECT_LE(characters(line), room) << line;
    EXPECT_EQ(count, 3U);
  }
}

TEST(Columns, LongNamesKeepBothEnds) {
  EXPECT_EQ(shortened("hig/poisson/adam/n=1024/seed=4", 16),
            "hig/pois…/seed=4");
  EXPECT_EQ(shortened("abc", 3), "abc");
  EXPECT_EQ(shortened("abcd", 3), "a…d");
  EXPECT_EQ(shortened("ééé", 2), "é…");
  EXPECT_EQ(shortened("abc", 0), "");
}

}  // namespace
}  // namespace physinv
