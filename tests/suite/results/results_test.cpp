#include "suite/results/results.h"

#include <gtest/gtest.h>

#include <cmath>

#include "suite/results/loss_summary.h"
#include "suite/results/published.h"
#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

CaseRecord sample_record(const std::string& method,
                         Index n,
                         std::uint64_t seed) {
  CaseRecord c;
  c.info = sample_case(method, n, seed);
  for (Index k = 0; k < 2; ++k) c.stages.push_back(sample_stage(c.info, k));
  return c;
}

TEST(Results, FindsByWhatACaseIs) {
  auto lost = sample_record("na", 8, 1);
  lost.stages[1].stop = Stop::failed;
  const Results results(
      {sample_record("jpo", 64, 1), sample_record("jpo", 8, 0), lost});
  const auto* stage = results.find("jpo/sample", "jpo", 8, 0, "refine");
  ASSERT_NE(stage, nullptr);
  EXPECT_EQ(stage->stage, "refine");
  EXPECT_EQ(stage->case_name, "jpo/sample/jpo/n=8/seed=0");
  EXPECT_EQ(results.find("jpo/sample", "jpo", 8, 1, "fit"), nullptr);
  EXPECT_EQ(results.find("jpo/sample", "jpo", 8, 0, "solve"), nullptr);
  EXPECT_EQ(results.find("jpo/sample", "na", 8, 1, "refine"), nullptr)
      << "a failed stage is not run";
  EXPECT_NE(results.find("jpo/sample", "na", 8, 1, "fit"), nullptr);
  EXPECT_EQ(results.sizes("jpo/sample"), (std::vector<Index>{8, 64}));
  EXPECT_EQ(results.seeds("jpo/sample"), (std::vector<std::uint64_t>{0, 1}));
  EXPECT_EQ(results.methods("jpo/sample"),
            (std::vector<std::string>{"jpo", "na"}));
  EXPECT_TRUE(results.sizes("other").empty());
}

TEST(Results, WorkIsThatOfStagesWithAResult) {
  auto lost = sample_record("na", 8, 1);
  lost.stages[1].stop = Stop::failed;
  Counts expected = lost.stages[0].counts;
  expected += lost.stages[0].counts;
  const auto other = lost.stages[0];
  lost.stages.insert(lost.stages.begin(), other);
  const auto work = work_of(Results({lost}));
  ASSERT_EQ(work.size(), 1U);
  EXPECT_EQ(work.at("jpo/sample"), expected);
}

TEST(LossSummary, WhatIsNotFiniteIsTheLargest) {
  StageRecord stage;
  EXPECT_FALSE(largest_loss_of(stage));
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    stage.loss = Vector<double>{{1, bad, 2}};
    EXPECT_EQ(*largest_loss_of(stage), HUGE_VAL);
    EXPECT_EQ(*mean_loss_of(stage), HUGE_VAL);
  }
  stage.loss = Vector<double>{{1, 3, 2}};
  EXPECT_EQ(*largest_loss_of(stage), 3);
}

TEST(Published, HasThePapersBilliardsNumbers) {
  const Published published(std::string(PHYSINV_SOURCE_DIR) +
                            "/reports/published");
  const auto get = [&](const char* quantity) {
    return published.find("jpo/billiards", quantity).value();
  };
  EXPECT_EQ(get("table2/jpo/fit").value, 115.2);
  EXPECT_EQ(get("table2/na/solve").spread, 2.5);
  EXPECT_EQ(get("table3/n=128").value, 98.1);
  EXPECT_EQ(get("table4/jpo/better").value, 44.3);
  EXPECT_FALSE(get("table4/jpo/better").spread);
  EXPECT_EQ(get("table5/na/equal").value, 98.4);
  EXPECT_EQ(get("table5/na/equal").where, "Table 5");
  EXPECT_FALSE(published.find("jpo/billiards", "table9"));
  EXPECT_EQ(published.find("jpo/navier-stokes", "table2/jpo/fit")->value,
            29510.0);
}

TEST(Published, SaysWhatTheNumbersWerePrintedIn) {
  const fs::path root = PHYSINV_SOURCE_DIR;
  const Published published(root / "reports/published");
  const std::string citation = read_file(root / "CITATION.cff");
  ASSERT_EQ(published.publications().size(), 4u);
  for (const Publication& p : published.publications()) {
    EXPECT_TRUE(contains(citation, p.title)) << p.title;
    EXPECT_TRUE(contains(citation, "arXiv:" + p.arxiv)) << p.arxiv;
  }
  EXPECT_EQ(published.publication("hig")->text(),
            "Patrick Schnell, Philipp Holl, Nils Thuerey: Half-Inverse "
            "Gradients for Physical Deep Learning. International Conference "
            "on Learning Representations (ICLR), 2022. arXiv:2203.10131");
  EXPECT_EQ(published.publication("none"), nullptr);
}

TEST(Published, MalformedFileIsNamed) {
  TemporaryDirectory directory;
  const std::string paper =
      R"({"publication": {"key": "a", "title": "A", "authors": ["B"],)"
      R"( "year": 2022, "venue": "C"})";
  write_file(directory / "bad.json", paper + R"(, "values": []})");
  EXPECT_EQ(Published(directory.path()).publication("a")->text(),
            "B: A. C, 2022.");
  for (const std::string& text :
       {std::string("{"),
        std::string(R"({"values": []})"),
        paper + "}",
        paper + R"(, "values": [{"quantity": 3}]})"}) {
    write_file(directory / "bad.json", text);
    const auto message =
        message_of<std::runtime_error>([&] { Published p(directory.path()); });
    EXPECT_TRUE(contains(message, "bad.json")) << message;
  }
  EXPECT_THROW(Published(directory / "nowhere"), std::runtime_error);
}

}  // namespace
}  // namespace physinv
