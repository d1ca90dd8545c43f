#include "reports/digest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reports/digest_tables.h"
#include "reports/joined_tables.h"
#include "reports/latest_claims.h"
#include "reports/results_page.h"
#include "reports/tables.h"
#include "suite/store/file.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

Section section(Verdict of_paper, Verdict of_suite) {
  return {.experiment = "jpo/toy",
          .title = "Toy",
          .paper = "jpo",
          .tables = {{.id = "t", .title = "A table", .columns = {"a"}}},
          .figures = {{.id = "curves",
                       .title = "Curves",
                       .where = "Fig. 3",
                       .panels = {{.series = {{.x = {1, 2}, .y = {1, 2}}}}}},
                      {.id = "picture",
                       .title = "Picture",
                       .panels = {{.field = Field2D{{1}, {1}, {1}}}}}},
          .claims = {{.id = "P1",
                      .says = "a | b",
                      .verdict = of_paper,
                      .evidence = "0.98 (> 0.5)",
                      .origin = Origin::paper,
                      .where = "Sec. 4",
                      .conditions = {{.label = "better",
                                      .bounds = "> 0.5",
                                      .value = 0.98,
                                      .spread = 0.01,
                                      .holds = true}}},
                     {.id = "R1", .says = "range", .verdict = of_suite}}};
}

Json origin() {
  return {{"profile", "paper"},
          {"date", "2024-05-06T07:08:09Z"},
          {"cpu_model", "A processor"},
          {"num_cpus", 2},
          {"git_revision", "abc"},
          {"papers", {"jpo: A. Author: A title. A venue, 2024."}}};
}

NamedDigest named(const char* name, Verdict of_paper, Verdict of_suite) {
  return {name, digest_json({section(of_paper, of_suite)}, origin())};
}

Json dated(Json provenance, const char* date) {
  provenance["date"] = date;
  return provenance;
}

void expect_words(const std::string& page,
                  std::initializer_list<const char*> all) {
  for (const char* words : all)
    EXPECT_NE(page.find(words), page.npos) << words << "\n" << page;
}

TEST(Digest, PageHasAnswersAndWhatIsNotReproduced) {
  auto campaign = named("first", Verdict::not_reproduced, Verdict::reproduced);
  campaign.cpu_seconds = {{"jpo/toy", 1800}, {"hig/toy", 7}};
  const std::vector<Publication> papers{
      {.key = "jpo",
       .title = "A title",
       .question = "Does it?",
       .main_claims = {{"jpo/toy", "P1"}, {"jpo/gone", "P2"}}}};
  const std::string page = results_markdown({campaign}, papers);
  expect_words(
      page,
      {"**A title** (jpo). Does it? a \\| b: **✗ not reproduced**, 0.98 ± "
       "0.01 (better: > 0.5), [jpo/toy P1](docs/results/jpo-toy.md).\n",
       "| [jpo/toy](docs/results/jpo-toy.md) P1 | a \\| b | 0.98 ± 0.01 "
       "(better: > 0.5) | not reproduced | unknown |",
       "\n- jpo: [toy](docs/results/jpo-toy.md) 0 of 1\n",
       "| jpo | 1 | 1 | 0.50 | A processor |",
       "| jpo | 0 | 0 | 0 | 1 | 0 |"});
  EXPECT_EQ(page.find("R1"), page.npos);
  expect_words(
      results_markdown({named("a", Verdict::reproduced, Verdict::reproduced)},
                       papers),
      {"a \\| b: **✓ reproduced**, 0.98",
       "toy](docs/results/jpo-toy.md) 1 of 1"});
}

TEST(Digest, PageOfRegressionChecksHasThoseThatFail) {
  const auto campaign =
      named("first", Verdict::reproduced, Verdict::not_reproduced);
  const std::string page = checks_markdown({campaign});
  expect_words(
      page,
      {kWrittenByResults,
       "| [jpo/toy](jpo-toy.md) R1 | range |  | not reproduced | unknown |",
       "| jpo | 0 | 0 | 1 | 0 |"});
  EXPECT_EQ(page.find("P1"), page.npos);
}

TEST(Digest, PageOfAnExperimentSaysWhereItsNumbersComeFrom) {
  const auto pages = experiment_pages(
      {named("first", Verdict::reproduced, Verdict::not_reproduced)});
  ASSERT_EQ(pages.size(), 1U);
  EXPECT_EQ(pages.begin()->first, "jpo-toy.md");
  expect_words(pages.begin()->second,
               {"# Toy (`jpo/toy`)",
                kWrittenByResults,
                "](../../RESULTS.md)",
                "| P1 | a \\| b (Sec. 4) | reproduced | 0.98 (> 0.5) | first |",
                "| R1 | range | not reproduced |",
                "## Campaign first",
                "`./bench reproduce first`",
                "2024-05-06, A processor (2 cores)",
                "A table",
                "![Fig. 3 · Curves](../../reports/campaigns/first/figures/"
                "jpo-toy-curves.svg)"});
}

TEST(LatestClaims, NewVerdictsAreThoseThatDifferOrAreGone) {
  const auto latest = [](Verdict of_paper, Verdict of_suite) {
    return latest_claims({named("a", of_paper, of_suite)});
  };
  const Papers then = latest(Verdict::reproduced, Verdict::reproduced);
  EXPECT_TRUE(new_verdicts(then, then).empty());
  const auto changed =
      new_verdicts(then, latest(Verdict::reproduced, Verdict::not_reproduced));
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_EQ(changed[0].key, ClaimKey("jpo/toy", "R1"));
  EXPECT_EQ(changed[0].now, Verdict::not_reproduced);
  const auto gone = new_verdicts(then, {});
  ASSERT_EQ(gone.size(), 2U);
  EXPECT_EQ(gone[0].now, Verdict::not_judged);
}

TEST(Digest, KeepsThePapersFiguresAndNoFilms) {
  Section kept = section(Verdict::reproduced, Verdict::reproduced);
  Figure& picture = kept.figures.emplace_back(kept.figures.back());
  picture.id = "fig6a", picture.where = "Fig. 6a";
  kept.figures.push_back(picture);
  kept.figures.back().id = "film", kept.figures.back().moment = 1;
  const auto files = kept_figures({kept});
  ASSERT_EQ(files.size(), 2U);
  for (const char* name : {"jpo-toy-curves.svg", "jpo-toy-fig6a.svg"})
    EXPECT_EQ(files.at(name).substr(0, 4), "<svg") << name;
}

/// A campaign of two experiments that share a table, and their paper's part.
std::vector<Section> with_shared_table(const char* label) {
  std::vector<Section> all = {{.experiment = "jpo", .paper = "jpo"}};
  for (const char* title : {"Toy", "Game"})
    all.push_back({.experiment = std::string("jpo/") + title,
                   .title = title,
                   .paper = "jpo",
                   .tables = {{.id = "table4",
                               .title = "Better than BFGS",
                               .where = "Table 4",
                               .unit = "%",
                               .corner = "equality",
                               .columns = {"JPO"},
                               .rows = {{*label != 0 ? label : title,
                                         {{.ours = 50, .paper = 62.5}}}}}}});
  return all;
}

TEST(Digest, PageOfAPaperHasTheTablesThatItsExperimentsShare) {
  const auto page = [](const std::vector<Section>& all) {
    return experiment_pages({{"first", digest_json(all, origin())}})
        .at("jpo.md");
  };
  expect_words(page(with_shared_table("strict")),
               {"**Table 4 · Better than BFGS [%]**",
                "| experiment, equality |",
                "| Toy, strict          | 50.0 |  62.5 |",
                "| Game, strict         | 50.0 |  62.5 |"});
  expect_words(page(with_shared_table("")),
               {"| Toy      | 50.0 |  62.5 |", "| Game     | 50.0 |  62.5 |"});
  auto kept = with_shared_table("strict");
  kept.front().tables = joined_tables(kept, "jpo");
  const std::string once = page(kept);
  EXPECT_EQ(once.find("**Table 4"), once.rfind("**Table 4"));
  kept.front().tables.clear();
  kept.pop_back();
  EXPECT_EQ(page(kept).find("Table 4"), std::string::npos);
}

TEST(Digest, TablesOfOtherColumnsOrPapersAreNotJoined) {
  auto all = with_shared_table("strict");
  EXPECT_EQ(joined_tables(all, "jpo").size(), 1U);
  EXPECT_TRUE(joined_tables(all, "hig").empty());
  all.back().tables.front().columns = {"Adam"};
  EXPECT_TRUE(joined_tables(all, "jpo").empty());
}

TEST(Digest, IdsAreInTheOrderOfTheirNumbers) {
  std::vector<std::string> ids{"P10", "A2", "P2b", "P2", "T", "P1"};
  std::sort(ids.begin(), ids.end(), [](const auto& a, const auto& b) {
    return ByNumber()({"jpo", a}, {"jpo", b});
  });
  EXPECT_EQ(ids,
            (std::vector<std::string>{"A2", "P1", "P2", "P2b", "P10", "T"}));
}

TEST(Digest, TheNewestByDateCountsWhateverItIsCalled) {
  const auto at = [](const char* name, const char* date, Verdict verdict) {
    return NamedDigest{name,
                       digest_json({section(verdict, Verdict::reproduced)},
                                   dated(origin(), date))};
  };
  for (const bool swap : {false, true}) {
    std::vector<NamedDigest> all{
        at("b", "2024-05-06", Verdict::reproduced),
        at("a", "2024-06-06", Verdict::not_reproduced)};
    if (swap) std::swap(all[0], all[1]);
    expect_words(results_markdown(all), {"| jpo | 0 | 0 | 0 | 1 | 0 |"});
    const std::string page = experiment_pages(all).begin()->second;
    EXPECT_LT(page.find("## Campaign a"), page.find("## Campaign b"));
  }
}

TEST(Digest, TheLastCampaignThatDecidedCounts) {
  const auto page = [](Verdict first, Verdict second) {
    auto later = named("b", second, Verdict::reproduced);
    later.digest["provenance"]["date"] = "2024-05-07T07:08:09Z";
    return results_markdown({named("a", first, Verdict::reproduced), later});
  };
  const auto counts = [](const std::string& text, const char* row) {
    return text.find(row) != text.npos;
  };
  EXPECT_TRUE(counts(page(Verdict::reproduced, Verdict::not_judged),
                     "| jpo | 1 | 0 | 0 | 0 | 0 |"));
  EXPECT_TRUE(counts(page(Verdict::reproduced, Verdict::not_reproduced),
                     "| jpo | 0 | 0 | 0 | 1 | 0 |"));
  EXPECT_TRUE(counts(page(Verdict::not_judged, Verdict::not_judged),
                     "| jpo | 0 | 0 | 0 | 0 | 1 |"));
  EXPECT_TRUE(counts(page(Verdict::not_reproduced, Verdict::reported),
                     "| jpo | 0 | 0 | 0 | 1 | 0 |"));
  EXPECT_TRUE(counts(page(Verdict::reported, Verdict::not_judged),
                     "| jpo | 0 | 0 | 0 | 0 | 1 |"));
}

TEST(Digest, WhoRanAPartAnewDoesNotDecideOfTheWhole) {
  const auto page = [](int first, int second) {
    const auto ran = [](NamedDigest campaign, int cases) {
      for (Json& s : campaign.digest["sections"])
        for (Json& claim : s["claims"]) claim["cases"] = cases;
      return campaign;
    };
    auto later = named("b", Verdict::not_reproduced, Verdict::reproduced);
    later.digest["provenance"]["date"] = "2024-05-07T07:08:09Z";
    return results_markdown(
        {ran(named("a", Verdict::reproduced, Verdict::reproduced), first),
         ran(later, second)});
  };
  expect_words(page(8, 2), {"| jpo | 1 | 0 | 0 | 0 | 0 |"});
  expect_words(page(8, 8), {"| jpo | 0 | 0 | 0 | 1 | 0 |"});
  expect_words(page(2, 8), {"| jpo | 0 | 0 | 0 | 1 | 0 |"});
}

TEST(Digest, StudiesStandInAParagraph) {
  Section study = section(Verdict::reproduced, Verdict::depends);
  study.experiment = "studies/a-choice";
  study.claims.erase(study.claims.begin());
  const std::string page =
      results_markdown({{"a", digest_json({study}, origin())}});
  expect_words(page,
               {"[a-choice](docs/results/studies-a-choice.md) depends\n"});
  EXPECT_EQ(page.find("| [studies/"), page.npos) << page;
  study.claims.push_back({.id = "S2", .says = "b", .verdict = Verdict::weaker});
  expect_words(results_markdown({{"a", digest_json({study}, origin())}}),
               {"studies-a-choice.md) depends, differs (weaker)\n"});
}

TEST(Digest, AStudyOfAMainStatementHasTheNumberOfEverySetting) {
  Section study = section(Verdict::depends, Verdict::reproduced);
  study.experiment = "studies/a-choice";
  auto& conditions = study.claims[0].conditions;
  conditions = {{.label = "A", .bounds = "> 50", .value = 75, .holds = true},
                {.label = "B",
                 .bounds = "> 50",
                 .value = 42,
                 .spread = 3,
                 .holds = false},
                {.label = "C", .bounds = "> 50", .missing = "not run"},
                {.label = "D", .bounds = "", .value = 7}};
  const std::string page = results_markdown(
      {{"a", digest_json({section(Verdict::reproduced, {}), study}, origin())}},
      {{.key = "jpo",
        .title = "A title",
        .question = "Does it?",
        .main_claims = {{"jpo/toy", "P1"}, {"studies/a-choice", "P1"}}}});
  expect_words(page,
               {"[jpo/toy P1](docs/results/jpo-toy.md). a \\| b: **? "
                "depends**, A 75; B 42 ± 3: no (each > 50), [studies/a-choice "
                "P1](docs/results/studies-a-choice.md).\n"});
}

TEST(Digest, PagesTellWorkMadeAndSaved) {
  auto run = named("a", Verdict::reproduced, Verdict::reproduced);
  EXPECT_EQ(experiment_pages({run}).begin()->second.find("Work:"),
            std::string::npos);
  Counts& counts = run.work["jpo/toy"];
  counts[Counter::forward] = 5, counts[Counter::vjp] = 30;
  counts[Counter::skipped_vjp] = 7, counts[Counter::abandoned_levels] = 2;
  counts.forget(Counter::skipped_terms);
  expect_words(
      experiment_pages({run}).begin()->second,
      {"\nWork: 5 simulations, 30 gradients. Saved: 7 gradients known "
       "to be zero. Given up: 2 decompositions of half-inverses. Not counted: "
       "`skipped_terms`.\n"});
}

TEST(Digest, WhatIsNotJudgedSaysWhatIsMissing) {
  Section waits = section(Verdict::not_judged, Verdict::not_judged);
  waits.claims[0].evidence = "needs the profile paper";
  waits.claims[0].cause = "an hour";
  waits.claims[0].conditions.clear();
  const std::vector<NamedDigest> all{{"a", digest_json({waits}, origin())}};
  expect_words(results_markdown(all), {"|  | not judged | an hour |"});
  expect_words(experiment_pages(all).begin()->second,
               {"| not judged | needs the profile paper **Cause: an hour**"});
}

TEST(Digest, SomethingElseIsNoDigest) {
  EXPECT_THROW(results_markdown({{"a", Json{{"sections", Json::array()}}}}),
               std::runtime_error);
  EXPECT_THROW(results_markdown({{"a", Json::array()}}), std::runtime_error);
  auto strange = named("a", Verdict::reproduced, Verdict::reported);
  strange.digest["sections"][0]["claims"][0]["verdict"] = "not_reproduced";
  EXPECT_THROW(results_markdown({strange}), std::runtime_error);
  EXPECT_THROW(experiment_pages({strange}), std::runtime_error);
}

TEST(Digest, TablesKeepTheirValues) {
  const Table table{
      .id = "t",
      .title = "Errors | of *all*",
      .where = "Table 4",
      .unit = "%",
      .digits = 2,
      .corner = "method <b>",
      .columns = {"n = 4", "n = 8"},
      .rows = {{"a|b", {{.ours = 1. / 3, .spread = 1, .paper = 7}}},
               {"_c_", {{}, {.text = "not run"}}},
               {"d", {{.ours = INFINITY}, {.paper = 2, .paper_spread = 0.5}}}},
      .note = "As it is & \\ was."};
  const Table back = table_from(Json::parse(table_json(table).dump()));
  EXPECT_EQ(to_markdown(back), to_markdown(table));
  EXPECT_EQ(back.where, "Table 4");
  EXPECT_EQ(back.rows[0].cells[0].ours, 1. / 3);
  EXPECT_FALSE(back.rows[1].cells[0].ours);
  EXPECT_EQ(back.rows[1].cells[1].text, "not run");
  EXPECT_FALSE(back.rows[2].cells[0].ours);
  EXPECT_EQ(back.rows[2].cells[1].paper_spread, 0.5);
}

TEST(Digest, TablesOfAnotherFormAreRefused) {
  Json table =
      table_json({.title = "A", .columns = {"a"}, .rows = {{"b", {}}}});
  EXPECT_NO_THROW(table_from(table));
  table["rows"][0].push_back("more");
  EXPECT_THROW(table_from(table), std::runtime_error);
  EXPECT_ANY_THROW(table_from("| a |"));
}

TEST(Digest, SectionsHaveClaimsAndTables) {
  const auto sections =
      sections_of(named("a", Verdict::reproduced, Verdict::reported).digest);
  ASSERT_FALSE(sections.empty());
  ASSERT_FALSE(sections[0].claims.empty());
  EXPECT_EQ(sections[0].claims[0].verdict, Verdict::reproduced);
  EXPECT_TRUE(sections[0].figures.empty());
}

TEST(Digest, SectionsOfACampaignHaveItsWork) {
  auto run = named("a", Verdict::reproduced, Verdict::reported);
  EXPECT_FALSE(sections_of(run)[0].work);
  run.work[sections_of(run)[0].experiment][Counter::forward] = 5;
  EXPECT_EQ((*sections_of(run)[0].work)[Counter::forward], 5U);
}

TEST(Digest, CompressedBytesComeBack) {
  std::string text;
  for (int i = 0; i < 10000; ++i) text += std::to_string(i % 97);
  const std::string packed = gzipped(text);
  EXPECT_LT(packed.size(), text.size() / 10);
  EXPECT_EQ(packed, gzipped(text));
  EXPECT_EQ(gunzipped(packed), text);
  EXPECT_EQ(gunzipped(packed, text.size()), text);
  EXPECT_THROW(gunzipped(packed, text.size() - 1), std::runtime_error);
  EXPECT_THROW(gunzipped(packed + "x"), std::runtime_error);
  EXPECT_THROW(gunzipped(packed.substr(0, packed.size() - 1)),
               std::runtime_error);
  EXPECT_THROW(gunzipped(""), std::runtime_error);
  EXPECT_EQ(gunzipped(gzipped("")), "");
}

}  // namespace
}  // namespace physinv
