#include "suite/harness/select.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "suite/harness/errors.h"

namespace physinv {
namespace {

TEST(NameFilter, UnitesAndNegates) {
  EXPECT_TRUE(NameFilter().matches("anything"));
  const NameFilter two({"/bfgs/", "n=4/"});
  EXPECT_TRUE(two.matches("jpo/billiards/bfgs/n=8/seed=0"));
  EXPECT_TRUE(two.matches("jpo/billiards/gd/n=4/seed=0"));
  EXPECT_FALSE(two.matches("jpo/billiards/gd/n=8/seed=0"));
  const NameFilter without({"-/bfgs/"});
  EXPECT_TRUE(without.matches("jpo/billiards/gd/n=8/seed=0"));
  EXPECT_FALSE(without.matches("jpo/billiards/bfgs/n=8/seed=0"));
  const NameFilter both({"billiards", "-seed=[1-9]"});
  EXPECT_TRUE(both.matches("jpo/billiards/gd/n=8/seed=0"));
  EXPECT_FALSE(both.matches("jpo/billiards/gd/n=8/seed=3"));
}

TEST(NameFilter, NamesABadPattern) {
  try {
    NameFilter({"good", "(bad"});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("(bad"), std::string::npos);
  }
}

TEST(NameFilter, IsLinearAndLimited) {
  const std::string name(2000, 'x');
  for (const char* slow : {"(.*)*(.*)*(.*)*QQ", "(x+x+)+y", "((a|x)*)*$b"})
    EXPECT_FALSE(NameFilter({slow}).matches(name)) << slow;
  EXPECT_TRUE(NameFilter({std::string(kLongestPattern, 'x')})
                  .matches(name + name + name));
  EXPECT_TRUE(NameFilter({std::string(2000, '(') + std::string(2000, ')')})
                  .matches(name));
  for (const std::string& bad :
       {std::string(kLongestPattern + 1, 'x'),
        std::string(10'000, '(') + std::string(10'000, ')'),
        std::string("(((x{1000}){1000}){1000})"),
        std::string("\xff"),
        std::string("(?<=a)b"),
        std::string("(a)\\1")})
    EXPECT_THROW(NameFilter({bad}), UsageError) << bad.substr(0, 20);
}

TEST(NameFilter, IsLimitedInSum) {
  std::vector<std::string> patterns(kLongestPatterns / 64,
                                    std::string(64, 'x'));
  EXPECT_FALSE(NameFilter(patterns).matches("y"));
  patterns.emplace_back("x");
  EXPECT_THROW(NameFilter{patterns}, UsageError);
}

TEST(NameFilter, SaysWhoseThePatternIs) {
  try {
    NameFilter({"(bad"}, "--count");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("--count='(bad'"));
  }
}

TEST(NameFilter, ExactlyMatchesOneName) {
  const std::vector<std::string> names = {
      "a/b+c/n=4", "a/bbc/n=4", "machine/fma<float>", "x.y", "xzy", "a|b", "a"};
  for (const auto& name : names)
    for (const auto& other : names)
      EXPECT_EQ(NameFilter({exactly(name)}).matches(other), name == other)
          << name << " " << other;
}

TEST(Shard, SplitsByPosition) {
  std::vector<Case> cases(7);
  for (std::size_t i = 0; i < 7; ++i) cases[i].info.name = std::to_string(i);
  std::string all;
  for (int part = 1; part <= 3; ++part) {
    for (const Case& c : Shard{part, 3}.apply(cases)) all += c.info.name;
  }
  EXPECT_EQ(all, "0361425");
  EXPECT_EQ(Shard().apply(cases).size(), 7u);
}

}  // namespace
}  // namespace physinv
