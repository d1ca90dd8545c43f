#include "reports/digest.h"

#include <gtest/gtest.h>

#include "reports/tables.h"
#include "suite/results/file.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

Section section(Verdict of_paper, Verdict of_suite) {
  return {.experiment = "jpo/toy",
          .title = "Toy",
          .paper = "jpo",
          .tables = {{.id = "t", .title = "A table", .columns = {"a"}}},
          .claims = {{.id = "P1",
                      .says = "a | b",
                      .verdict = of_paper,
                      .evidence = "0.98 (> 0.5)",
                      .origin = Origin::paper,
                      .where = "Sec. 4"},
                     {.id = "R1", .says = "range", .verdict = of_suite}}};
}

Json origin() {
  return {{"profile", "paper"},
          {"date", "2024-05-06T07:08:09Z"},
          {"cpu_model", "A processor"},
          {"num_cpus", 2},
          {"papers", {"jpo: A. Author: A title. A venue, 2024."}},
          {"options",
           {{"filter", {"jpo/", "-head"}}, {"set", {"n=8"}}, {"seeds", "3"}}}};
}

NamedDigest named(const char* name, Verdict of_paper, Verdict of_suite) {
  return {name, digest_json({section(of_paper, of_suite)}, origin())};
}

TEST(Digest, PageSaysWhereItsNumbersComeFrom) {
  const std::string page = results_markdown(
      {named("first", Verdict::reproduced, Verdict::not_reproduced)});
  for (const char* words :
       {"## Campaign first",
        "`./bench --profile=paper '--filter=jpo/' '--filter=-head' "
        "'--set=n=8' --seeds=3`",
        "2024-05-06, A processor (2 cores)",
        "| P1 | a \\| b (Sec. 4) | reproduced | 0.98 (> 0.5) |",
        "| R1 | range | fails |",
        "A table",
        "- jpo: A. Author: A title. A venue, 2024.",
        "| jpo | 1 | 0 | 0 | 0 | 0 | 1 | 0 | 0 |"})
    EXPECT_NE(page.find(words), page.npos) << words << "\n" << page;
}

TEST(Digest, TheLastCampaignThatDecidedCounts) {
  const auto page = [](Verdict first, Verdict second) {
    return results_markdown({named("a", first, Verdict::reproduced),
                             named("b", second, Verdict::reproduced)});
  };
  const auto counts = [](const std::string& text, const char* row) {
    return text.find(row) != text.npos;
  };
  EXPECT_TRUE(counts(page(Verdict::reproduced, Verdict::not_judged),
                     "| jpo | 1 | 0 | 0 | 0 | 1 |"));
  EXPECT_TRUE(counts(page(Verdict::reproduced, Verdict::not_reproduced),
                     "| jpo | 0 | 1 | 0 | 0 | 1 |"));
  EXPECT_TRUE(counts(page(Verdict::not_judged, Verdict::not_judged),
                     "| jpo | 0 | 0 | 1 | 0 | 1 |"));
  EXPECT_TRUE(counts(page(Verdict::not_reproduced, Verdict::reported),
                     "| jpo | 0 | 1 | 0 | 0 | 1 |"));
  EXPECT_TRUE(counts(page(Verdict::reported, Verdict::not_judged),
                     "| jpo | 0 | 0 | 0 | 1 | 1 |"));
}

TEST(Digest, WhatIsNotJudgedIsNamedByWhatIsMissing) {
  Section waits = section(Verdict::not_judged, Verdict::not_judged);
  waits.claims[0].evidence = "needs the profile paper";
  const std::string page =
      results_markdown({{"a", digest_json({waits}, origin())}});
  EXPECT_NE(page.find("- P1: needs the profile paper"), page.npos);
  EXPECT_EQ(page.find("| P1 |"), page.npos);
}

TEST(Digest, SomethingElseIsNoDigest) {
  EXPECT_THROW(results_markdown({{"a", Json{{"sections", Json::array()}}}}),
               std::runtime_error);
  EXPECT_THROW(results_markdown({{"a", Json::array()}}), std::runtime_error);
  auto strange = named("a", Verdict::reproduced, Verdict::reported);
  strange.digest["sections"][0]["claims"][0]["verdict"] = "not_reproduced";
  EXPECT_THROW(results_markdown({strange}), std::runtime_error);
}

TEST(Digest, TablesComeBackAsWords) {
  const Table table{.id = "t",
                    .title = "Errors | of *all*",
                    .source = "Table 4",
                    .unit = "%",
                    .digits = 1,
                    .corner = "method <b>",
                    .columns = {"n = 4", "n = 8"},
                    .rows = {{"a|b", {{.ours = 5, .spread = 1, .paper = 7}}},
                             {"_c_", {{}, {.text = "not run"}}}},
                    .note = "As it is & \\ was."};
  const Table back = table_of(to_markdown(table), "t");
  EXPECT_EQ(back.source, "Table 4");
  EXPECT_EQ(back.title, "Errors | of *all* [%]");
  EXPECT_EQ(back.corner, "method <b>");
  EXPECT_EQ(back.columns,
            (std::vector<std::string>{"n = 4", "paper", "n = 8"}));
  ASSERT_EQ(back.rows.size(), 2U);
  EXPECT_EQ(back.rows[0].label, "a|b");
  EXPECT_EQ(back.rows[0].cells[0].text, "5.0 ± 1.0");
  EXPECT_EQ(back.rows[0].cells[1].text, "7.0");
  EXPECT_EQ(back.rows[1].label, "_c_");
  EXPECT_EQ(back.rows[1].cells[2].text, "not run");
  EXPECT_EQ(back.note, "As it is & \\ was.");
  EXPECT_THROW(table_of("no table", "t"), std::runtime_error);
}

TEST(Digest, SectionsHaveClaimsAndTables) {
  const auto sections =
      sections_of(named("a", Verdict::reproduced, Verdict::reported).digest);
  ASSERT_FALSE(sections.empty());
  ASSERT_FALSE(sections[0].claims.empty());
  EXPECT_EQ(sections[0].claims[0].verdict, Verdict::reproduced);
  EXPECT_TRUE(sections[0].figures.empty());
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
