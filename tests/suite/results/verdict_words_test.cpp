#include "suite/results/verdict_words.h"

#include <gtest/gtest.h>

#include <set>

namespace physinv {
namespace {

TEST(VerdictWords, SayOneVerdictEach) {
  std::set<std::string_view> marks;
  for (const Verdict v : kVerdicts)
    EXPECT_EQ(verdict_of(words_of(v)), v) << words_of(v);
  for (const Verdict v : kVerdicts) marks.insert(mark_of(v));
  EXPECT_EQ(marks.size(), kVerdicts.size());
}

TEST(VerdictWords, WordsOfEarlierVersionsAreRead) {
  EXPECT_EQ(verdict_of("holds"), Verdict::reproduced);
  EXPECT_EQ(verdict_of("fails"), Verdict::not_reproduced);
  EXPECT_EQ(verdict_of("differs"), Verdict::differs);
}

TEST(VerdictWords, OtherWordsAreNone) {
  for (const char* word : {"", "hold", "not_reproduced", "Reproduced"})
    EXPECT_FALSE(verdict_of(word)) << word;
}

TEST(VerdictWords, RareOnesHaveAColumnWhereTheyOccur) {
  VerdictCounts counts{};
  const std::vector<Verdict> always = {Verdict::reproduced,
                                       Verdict::not_reproduced,
                                       Verdict::not_judged,
                                       Verdict::reported};
  EXPECT_EQ(columns_of(counts), always);
  counts[static_cast<std::size_t>(Verdict::depends)] = 1;
  EXPECT_EQ(columns_of(counts).size(), always.size() + 1);
  EXPECT_EQ(columns_of(counts)[1], Verdict::depends);
}

}  // namespace
}  // namespace physinv
