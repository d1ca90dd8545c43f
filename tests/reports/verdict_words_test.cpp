// A verdict has one word in every output.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "reports/html.h"
#include "reports/report.h"
#include "reports/results_page.h"
#include "suite/compare/pages.h"

namespace physinv {
namespace {

class WordsOf : public testing::TestWithParam<std::tuple<Verdict, Origin>> {
 protected:
  Verdict verdict_ = std::get<0>(GetParam());
  Origin origin_ = std::get<1>(GetParam());
  std::string words_{words_of(verdict_)};
  ClaimResult claim_{.id = "R1",
                     .says = "a",
                     .from = "quick",
                     .verdict = verdict_,
                     .evidence = "runs",
                     .origin = origin_,
                     .cause = "a choice"};
  std::string cause_ = cause_text(verdict_, "a choice");
  std::vector<Section> sections_{{.experiment = "jpo/toy",
                                  .title = "Toy",
                                  .paper = "jpo",
                                  .claims = {claim_}}};
};

TEST_P(WordsOf, StandInTheReport) {
  const std::string mark(mark_of(verdict_));
  const std::string text = report_markdown(sections_, {});
  EXPECT_NE(text.find("| R1 | a | " + mark + " " + words_ + " |"), text.npos)
      << text;
  const std::string page = report_html(sections_, {});
  EXPECT_NE(page.find(">" + mark + " " + words_ + "</td>"), page.npos);
  EXPECT_NE(render_claims_text(sections_, 80).find("R1   " + words_),
            std::string::npos);
  EXPECT_EQ(to_json(claim_)["verdict"], words_);
  EXPECT_EQ(claim_from(to_json(claim_)).verdict, verdict_);
}

TEST_P(WordsOf, AreDefinedInTheDocumentation) {
  std::ifstream file(PHYSINV_SOURCE_DIR "/docs/verdicts.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  const std::string row =
      fmt::format("\n| {} | {} | ", mark_of(verdict_), words_of(verdict_));
  EXPECT_NE(page.find(row), page.npos) << row;
}

TEST_P(WordsOf, ComeWithTheirCause) {
  EXPECT_NE(report_markdown(sections_, {}).find(cause_), std::string::npos);
  EXPECT_NE(report_html(sections_, {}).find(cause_), std::string::npos);
  EXPECT_NE(render_claims_text(sections_, 200).find(cause_), std::string::npos);
  EXPECT_EQ(claim_from(to_json(claim_)).cause, "a choice");
  const std::vector<NamedDigest> all{
      {"a", digest_json(sections_, {{"profile", "quick"}})}};
  EXPECT_NE(experiment_pages(all).begin()->second.find(cause_),
            std::string::npos);
  const bool of_paper = origin_ == Origin::paper;
  const std::string page =
                        of_paper ? results_markdown(all) : checks_markdown(all),
                    other =
                        of_paper ? checks_markdown(all) : results_markdown(all),
                    row = fmt::format("| a |  | {} | a choice |", words_);
  const bool shown =
      verdict_ != Verdict::reproduced && verdict_ != Verdict::reported;
  EXPECT_EQ(page.find(row) != page.npos, shown) << page;
  EXPECT_EQ(other.find(row), other.npos) << other;
}

TEST_P(WordsOf, StandInThePageOfAnExperiment) {
  const std::string page =
      experiment_pages({{"a", digest_json(sections_, {{"profile", "quick"}})}})
          .begin()
          ->second;
  const std::string row = "| R1 | a | " + words_ + " | runs **";
  EXPECT_NE(page.find(row), page.npos) << row << "\n" << page;
}

TEST_P(WordsOf, StandInAComparison) {
  const std::vector<ChangedClaim> changed{
      {.experiment = "jpo/toy", .sides = {claim_, std::nullopt}}};
  const Table table = claims_table(changed, {"a", "b"});
  EXPECT_EQ(table.rows[0].cells[0].text, words_);
  EXPECT_EQ(table.rows[0].cells[1].text, words_of(Verdict::not_judged));
  EXPECT_EQ(
      to_json(Comparison{}, changed, {})["changed_claims"][0]["verdicts"][0],
      words_);
}

INSTANTIATE_TEST_SUITE_P(VerdictWords,
                         WordsOf,
                         testing::Combine(testing::ValuesIn(kVerdicts),
                                          testing::Values(Origin::paper,
                                                          Origin::suite)));

}  // namespace
}  // namespace physinv
