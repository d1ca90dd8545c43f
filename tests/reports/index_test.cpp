#include <gtest/gtest.h>

#include "reports/anchors.h"
#include "reports/html.h"
#include "reports/html_parts.h"
#include "reports/key_figure.h"
#include "reports/statements.h"

namespace physinv {
namespace {

ClaimResult claim(const char* id, Verdict verdict, double value) {
  return {.id = id,
          .says = std::string(id) + " is <so>",
          .from = "paper",
          .verdict = verdict,
          .evidence = "measured",
          .origin = Origin::paper,
          .where = "Fig. 1",
          .note = "as it is",
          .conditions = {{.label = "x",
                          .bounds = "> 2",
                          .value = value,
                          .holds = verdict == Verdict::reproduced}}};
}

std::vector<Section> sections() {
  Section one{.experiment = "jpo/toy", .title = "Toy"};
  one.claims = {claim("P1", Verdict::reproduced, 3),
                claim("P2", Verdict::not_reproduced, 1.25),
                claim("P3", Verdict::not_judged, 0),
                claim("P4", Verdict::not_judged, 0)};
  one.tables = {{.id = "t1",
                 .title = "T",
                 .where = "Table 1",
                 .unit = "%",
                 .columns = {"a"},
                 .rows = {{"row", {{.ours = 5, .paper = 7}}}}},
                {.id = "t2",
                 .title = "Times",
                 .where = "Table 2",
                 .unit = "CPU s",
                 .columns = {"a"},
                 .rows = {{"row", {{.ours = 5, .paper = 7}}}}}};
  return {one,
          {.experiment = "matrix/toy", .title = "Every method"},
          {.experiment = "sip/toy", .title = "Third"}};
}

std::string index(std::size_t front = 0) {
  return index_html(
      sections(),
      {.one_file = false,
       .groups = {{.key = "sip",
                   .title = "SIP paper",
                   .text = "A. Author",
                   .link = "https://arxiv.org/abs/1"},
                  {.key = "jpo", .title = "JPO paper", .text = "", .link = ""},
                  {.key = "hig", .title = "HIG paper", .text = "", .link = ""}},
       .front = front},
      {{"date", "2026-01-01"}});
}

TEST(Index, GroupsAreInTheOrderAskedFor) {
  const std::string page = index();
  const auto at = [&](const char* text) { return page.find(text); };
  EXPECT_LT(at(">SIP paper</h2>"), at(">JPO paper</h2>"));
  EXPECT_LT(at(">JPO paper</h2>"), at(">matrix</h2>"));
  EXPECT_NE(at(">matrix</h2>"), page.npos) << "what no group has comes last";
  EXPECT_EQ(at("HIG paper"), page.npos) << "a group without experiments";
  EXPECT_NE(at("href=\"https://arxiv.org/abs/1\""), page.npos);
  for (const char* folder : {"jpo-toy", "matrix-toy", "sip-toy"})
    EXPECT_NE(at(("href=\"" + std::string(folder) + "/index.html\"").c_str()),
              page.npos);
}

TEST(Index, SectionsInFrontStandThereWhole) {
  const std::string page = index(1);
  EXPECT_NE(page.find("href=\"jpo-toy/tables/t1.csv\""), page.npos);
  EXPECT_EQ(page.find("jpo-toy/index.html"), page.npos);
  EXPECT_LT(page.find("id=\"jpo-toy\""), page.find(">SIP paper</h2>"));
  EXPECT_EQ(page.find(">JPO paper</h2>"), page.npos);
}

TEST(Index, FailingStatementsAreSentencesAndOpenOnesALine) {
  const std::string page = index();
  EXPECT_NE(
      page.find(
          "<a href=\"jpo-toy/index.html#jpo-toy-P2\"><strong>P2</strong></a> "
          "P2 "
          "is &lt;so&gt; (Fig. 1): x 1.25, not &gt; 2. as it is"),
      page.npos);
  EXPECT_EQ(page.find("P3 is"), page.npos);
  EXPECT_NE(page.find("2 not judged; decided by profile paper"), page.npos);
  EXPECT_LT(page.size(), 40'000U);
}

Figure curves_of(const char* title, const char* x_label, bool y_log) {
  const Series one{
      .label = "A <1>", .method = "a", .x = {1, 2, 3}, .y = {3, 2, 1}},
      other{.label = "B", .method = "b", .x = {1, 2, 3}, .y = {3, 1, 0.1}};
  Panel panel{.title = "n = 8",
              .x_label = x_label,
              .y_label = "loss",
              .x_log = true,
              .y_log = y_log,
              .series = {one, other}};
  Panel larger = panel;
  larger.title = "n = 16";
  return {.id = "f", .title = title, .panels = {panel, larger}};
}

TEST(Index, ACardHasLearningCurvesAnAnswerAndVerdicts) {
  auto all = sections();
  all[0].standing = "JPO ranks best <of 2>";
  all[0].figures = {curves_of("Costs", "seconds", true),
                    curves_of("Learning", "updates", true)};
  const std::string page = index_html(all, {.one_file = false}, {});
  const auto begin = page.find("<article class=\"card\">");
  const std::string card =
      page.substr(begin, page.find("</article>", begin) - begin);
  for (const char* part :
       {"<a href=\"jpo-toy/index.html\">Toy</a>",
        "src=\"jpo-toy/card.svg\" alt=\"Learning, n = 16: loss over updates; "
        "A &lt;1&gt;, B\"",
        "<p class=\"answer\">JPO ranks best &lt;of 2&gt;.</p>",
        "✓ 1 reproduced</span>, <span class=\"no\">✗ 1 not reproduced</span>, "
        "<span class=\"open\">– 2 not judged</span>"})
    EXPECT_NE(card.find(part), card.npos) << part << '\n' << card;
  EXPECT_EQ(page.find("sip-toy/card.svg"), page.npos) << "has no figure";
  EXPECT_LT(page.rfind("</article>"), page.find("P2 is &lt;so&gt;"))
      << "sentences stand below all cards";
  EXPECT_LT(page.find("P2 is &lt;so&gt;"), page.find("<footer"));
  EXPECT_NE(page.find("img-src 'self' data:;"), page.npos);
}

TEST(Index, TheKeyFigureIsOfLearningCurves) {
  Section one{.experiment = "e", .title = "E"};
  EXPECT_FALSE(key_figure(one));
  Figure bars = curves_of("Bars", "n", false),
         none{.id = "none", .title = "None", .panels = {Panel{}}};
  one.figures = {none, bars};
  ASSERT_TRUE(key_figure(one));
  EXPECT_EQ(key_figure(one)->title, "Bars");
  EXPECT_EQ(key_figure(one)->panels.front().title, "n = 8") << "the first";
  one.figures.push_back(curves_of("Costs", "seconds", true));
  EXPECT_EQ(key_figure(one)->title, "Costs");
  one.figures.push_back(curves_of("Learning", "iteration + 1", true));
  one.figures.push_back(curves_of("More", "updates", true));
  EXPECT_EQ(key_figure(one)->title, "Learning") << "the first of its kind";
  ASSERT_EQ(key_figure(one)->panels.size(), 1U);
  EXPECT_EQ(key_figure(one)->panels.front().title, "n = 16") << "the last";
}

TEST(Index, WithoutFiguresACardShowsWhatWasDrawnBefore) {
  const Section one{.experiment = "jpo/toy", .title = "Toy"};
  const std::vector<Picture> drawn = {
      {.title = "Fig. 1 · Task", .svg = "<svg>1</svg>", .note = {}},
      {.title = "Fig. 2 · Learning curves", .svg = "<svg>2</svg>", .note = {}}};
  EXPECT_EQ(card_svg(one, {}, drawn), "<svg>2</svg>");
  EXPECT_EQ(card_text(one, drawn), "Fig. 2 · Learning curves");
  EXPECT_FALSE(card_svg(one, {}, {}));
  EXPECT_FALSE(card_text(one, {}));
}

TEST(Index, ACardShowsOneProblemBeforeAndAfter) {
  Figure shots{.id = "picture", .title = "One shot", .picture = true};
  for (const char* title :
       {"truth: on target", "start: 0.5 off", "JPO: 0.1 off"})
    shots.panels.push_back(
        {.title = title, .series = {{.x = {0, 1}, .y = {0, 1}}}});
  Section one{.experiment = "jpo/toy", .title = "Toy", .figures = {shots}};
  const auto both = before_and_after(one);
  ASSERT_TRUE(both);
  ASSERT_EQ(both->panels.size(), 2U);
  EXPECT_EQ(both->title, "start: 0.5 off, then JPO: 0.1 off");
  const std::string page = index_html({one}, {.one_file = false}, {});
  EXPECT_NE(page.find("src=\"jpo-toy/card-picture.svg\" alt=\"start: 0.5 off"),
            page.npos)
      << page;
  one.figures.front().panels.pop_back();
  EXPECT_FALSE(before_and_after(one)) << "nothing after the first guess";
}

TEST(Index, ACardShowsWhatTheBestMethodFound) {
  Figure fields{.id = "picture", .title = "Fields", .picture = true};
  for (const char* title :
       {"observed y*", "truth x*", "SIP, y", "SIP, x", "Adam, y", "Adam, x"})
    fields.panels.push_back({.title = title});
  Section one{.experiment = "sip/toy", .title = "Toy", .figures = {fields}};
  ASSERT_TRUE(before_and_after(one));
  EXPECT_EQ(before_and_after(one)->title, "truth x*, then Adam, x") << "last";
  one.tables = {
      {.id = "other", .rows = {{.label = "Adam"}}},
      {.id = "standings", .rows = {{.label = "not drawn"}, {.label = "SIP"}}}};
  EXPECT_EQ(before_and_after(one)->title, "truth x*, then SIP, x");
}

/// What a sentence of the index says of one claim.
std::string sentence_of(const ClaimResult& claim) {
  Section one{.experiment = "jpo/toy", .title = "Toy", .claims = {claim}};
  const std::string page = index_html({one}, {.one_file = false}, {});
  const auto at = page.find("<ul class=\"failing\">");
  return at == page.npos ? "" : page.substr(at, page.find("</ul>", at) - at);
}

TEST(Index, WhatIsExplainedHasItsCause) {
  for (const Verdict verdict : {Verdict::stronger,
                                Verdict::weaker,
                                Verdict::differs,
                                Verdict::depends,
                                Verdict::contradiction}) {
    ClaimResult c = claim("P5", verdict, 1.25);
    c.cause = "the rate is not printed";
    const std::string words = sentence_of(c);
    EXPECT_NE(words.find("x 1.25, not &gt; 2"), words.npos) << words;
    EXPECT_NE(words.find("Cause: the rate is not printed"), words.npos)
        << words;
    EXPECT_NE(words.find(words_of(verdict)), words.npos);
  }
  EXPECT_EQ(sentence_of(claim("P1", Verdict::reproduced, 3)), "");
  EXPECT_EQ(sentence_of(claim("P1", Verdict::reported, 3)), "");
}

TEST(Index, WhatIsJudgedInPartSaysWhatIsMissing) {
  ClaimResult c = claim("P6", Verdict::partly_judged, 3);
  c.conditions.front().holds = true;
  c.conditions.push_back({.label = "y", .bounds = "< 1", .missing = "not run"});
  c.cause = "an hour";
  const std::string words = sentence_of(c);
  EXPECT_NE(words.find("x 3, &gt; 2; y: not run"), words.npos) << words;
  EXPECT_NE(words.find("an hour"), words.npos) << words;
}

TEST(Anchors, PlacesOfAPaper) {
  using Places = std::vector<std::string>;
  EXPECT_EQ(places_of("Figs. 2, 5 and 6a, Table 4"),
            (Places{"fig 2", "fig 5", "fig 6", "table 4"}));
  EXPECT_EQ(places_of("Sec. 3.3, Figs. 4, 8 to 11, Table 5"),
            (Places{"fig 4", "fig 8", "fig 9", "fig 10", "fig 11", "table 5"}));
  EXPECT_EQ(places_of("App. D.1, Fig. 25(b)"), (Places{"fig 25"}));
  EXPECT_EQ(places_of("Sec. 4; Figure 3 (left)"), (Places{"fig 3"}));
  EXPECT_EQ(places_of("eq. 7"), Places{});
  EXPECT_TRUE(share_place("Fig. 3, App. D", "Figs. 2 and 3"));
  EXPECT_FALSE(share_place("Fig. 3", "Table 3"));
  EXPECT_FALSE(share_place("", ""));
}

TEST(Index, APageOfAnExperimentLinksItsData) {
  const auto all = sections();
  const std::string page = section_page_html(all[0], {}, Palette(all));
  for (const char* link : {"../index.html", "tables/t1.csv", "tables/t2.json"})
    EXPECT_NE(page.find("href=\"" + std::string(link) + "\""), page.npos)
        << link;
}

TEST(Statements, DecidedOnesThenTablesWithoutTimes) {
  const auto all = statements_of(sections()[0], 8);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].what.substr(0, 2), "P2");
  EXPECT_EQ(all[0].here, "1.25");
  EXPECT_EQ(all[0].paper, "x > 2");
  EXPECT_EQ(all[1].here, "3");
  EXPECT_EQ(all[2].what, "Table 1: a, row");
  Section own = sections()[0];
  own.title = "row";
  EXPECT_EQ(statements_of(own, 8)[2].what, "Table 1: a");
  own.claims.front().origin = Origin::suite;
  own.claims.front().verdict = Verdict::not_reproduced;
  EXPECT_EQ(statements_of(own, 8)[1].paper, "x > 2");
  EXPECT_EQ(all[2].here, "5.0 %");
  EXPECT_EQ(all[2].paper, "7.0 %");
  EXPECT_EQ(all[2].verdict, Verdict::not_judged);
  EXPECT_EQ(statements_of(sections()[0], 1).size(), 1U);
}

}  // namespace
}  // namespace physinv
