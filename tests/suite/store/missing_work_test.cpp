#include "suite/store/missing_work.h"

#include <gtest/gtest.h>

#include "suite/store/catalog.h"
#include "suite/store/store.h"
#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

class MissingWorkTest : public testing::Test {
 protected:
  MissingWorkTest() {
    Store store(out_.path());
    store.set_plan({a_, b_, c_}, nlohmann::json::object());
    for (Index k = 0; k < 2; ++k)
      store.append(a_, sample_data(a_), sample_stage(a_, k));
    store.append(b_, sample_data(b_), sample_stage(b_, 0));
  }
  MissingWork lacks() const {
    const Catalog catalog = Catalog::read(out_.path());
    return missing_work(catalog, catalog.cases());
  }
  void append(const CaseInfo& info, Index position, Stop stop) {
    auto stage = sample_stage(info, position);
    stage.stop = stop;
    Store(out_.path()).append(info, sample_data(info), stage);
  }

  TemporaryDirectory out_;
  CaseInfo a_ = sample_case("a", 4, 0), b_ = sample_case("b", 4, 0),
           c_ = sample_case("c", 4, 0);
};

TEST_F(MissingWorkTest, CompleteCampaignLacksNothing) {
  append(b_, 1, Stop::iterations);
  for (Index k = 0; k < 2; ++k) append(c_, k, Stop::diverged);
  EXPECT_FALSE(lacks().any()) << to_text(lacks());
  EXPECT_EQ(to_text(lacks()), "");
  EXPECT_EQ(lacks().stages, 6U);
}

TEST_F(MissingWorkTest, UnrunCasesAndStages) {
  EXPECT_TRUE(lacks().any());
  EXPECT_EQ(to_text(lacks()),
            "1 cases not run (first " + c_.name +
                "), 1 stages not run (first " + b_.name + " refine)");
}

TEST_F(MissingWorkTest, FailedStages) {
  append(b_, 1, Stop::failed);
  EXPECT_EQ(lacks().failed, std::vector{b_.name + " refine"});
  EXPECT_TRUE(lacks().unrun_stages.empty());
}

TEST_F(MissingWorkTest, DeletedCaseFile) {
  std::filesystem::remove(Catalog(out_.path()).case_path(a_.name));
  EXPECT_EQ(lacks().lost, (std::vector{a_.name + " fit", a_.name + " refine"}));
  EXPECT_TRUE(contains(to_text(lacks()), "2 stages lost their arrays"));
}

TEST_F(MissingWorkTest, DeletedPlan) {
  std::filesystem::remove(out_ / "plan.json");
  EXPECT_TRUE(lacks().unknown_plan);
  EXPECT_TRUE(contains(to_text(lacks()), "plan.json is missing"));
}

}  // namespace
}  // namespace physinv
