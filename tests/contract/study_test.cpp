// A study sees what the experiment sees that it varies.
#include "suite/harness/study.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "suite/harness/keys.h"
#include "suite/harness/registry.h"

namespace physinv {
namespace {

std::vector<Case> cases_of(const std::string& experiment,
                           const std::string& profile) {
  std::vector<Case> found;
  for (Case& c : registry().expand(profile))
    if (c.info.experiment == experiment) found.push_back(std::move(c));
  return found;
}

/// The first stage of a method at the smallest n and seed.
std::string first_recipe(const std::vector<Case>& cases,
                         const std::string& method,
                         const std::string& stage) {
  for (const Case& c : cases)
    if (c.info.method == method && c.info.n == 2 && c.info.seed == 0 &&
        c.info.stages.front() == stage)
      return recipe_text(c, 0);
  return "";
}

/// Of one n and seed, the smallest first.
std::vector<std::pair<Case, Case>> pairs_of(std::vector<Case> own,
                                            const std::vector<Case>& others) {
  std::stable_sort(own.begin(), own.end(), [](const Case& a, const Case& b) {
    return a.info.n < b.info.n;
  });
  std::vector<std::pair<Case, Case>> pairs;
  for (const Case& c : own)
    for (const Case& other : others)
      if (c.info.n == other.info.n && c.info.seed == other.info.seed)
        pairs.emplace_back(c, other);
  return pairs;
}

/// Where a study varies the problem, the same truths, or what is seen of them.
void expect_same_data(const Case& study, const Case& varied) {
  const CaseData a = draw_data(study), b = draw_data(varied);
  if (study.experiment->problem.options == varied.experiment->problem.options)
    EXPECT_EQ(a.hash, b.hash) << study.info.name;
  else
    EXPECT_TRUE(a.x == b.x || a.y.isApprox(b.y, 1e-9)) << study.info.name;
}

TEST(Study, SeesTheDataOfWhatItVaries) {
  ASSERT_FALSE(studies().empty());
  for (const auto& [study, varied] : studies()) {
    ASSERT_NE(registry().find(study), nullptr) << study;
    ASSERT_NE(registry().find(varied), nullptr) << varied;
    EXPECT_EQ(streams_of(study), varied);
    EXPECT_EQ(streams_of(varied), varied);
    auto pairs = pairs_of(cases_of(study, "study"), cases_of(varied, "paper"));
    ASSERT_FALSE(pairs.empty()) << study;
    if (pairs.size() > 2) pairs.erase(pairs.begin() + 2, pairs.end());
    for (const auto& [own, other] : pairs) expect_same_data(own, other);
  }
}

TEST(Study, StagesOfEqualOptionsHaveOneKeyAndOthersHaveNot) {
  const auto own = cases_of("studies/billiards-precision", "study");
  const auto paper = cases_of("jpo/billiards", "paper");
  EXPECT_EQ(first_recipe(own, "jpo-f64-5", "fit"),
            first_recipe(paper, "jpo", "fit"));
  EXPECT_NE(first_recipe(own, "bfgs-f64-5", "solve"), "");
  EXPECT_NE(first_recipe(own, "bfgs-f64-7", "solve"),
            first_recipe(own, "bfgs-f32-7", "solve"));
  EXPECT_EQ(first_recipe(paper, "bfgs", "solve").find("gtol=0"),
            std::string::npos);
  EXPECT_EQ(first_recipe(paper, "bfgs", "solve").find("single"),
            std::string::npos);
}

TEST(Study, VariesAnExperimentThatIsNone) {
  EXPECT_THROW(register_study("studies/a", "studies/a"), std::logic_error);
  EXPECT_THROW(register_study("studies/b", "studies/billiards-precision"),
               std::logic_error);
  EXPECT_THROW(register_study("studies/billiards-precision", "jpo/robotic-arm"),
               std::logic_error);
}

}  // namespace
}  // namespace physinv
