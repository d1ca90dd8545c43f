#include "reports/html.h"

#include <gtest/gtest.h>

#include <limits>
#include <regex>
#include <set>

#include "reports/anchors.h"
#include "reports/html_parts.h"
#include "tests/reports/xml_check.h"

namespace physinv {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != text.npos;
       at = text.find(part, at + part.size())) {
    ++found;
  }
  return found;
}

// What is between the first two marks after `from`.
std::string between(const std::string& text,
                    const std::string& from,
                    const std::string& to) {
  const auto a = text.find(from);
  if (a == text.npos) return "";
  return text.substr(a, text.find(to, a) - a);
}

// The page without the words in which < and & are no markup.
std::string markup(std::string page) {
  const std::string doctype = "<!DOCTYPE html>\n";
  EXPECT_TRUE(page.starts_with(doctype));
  page.erase(0, doctype.size());
  for (const std::string name : {"style", "script"}) {
    const auto a = page.find("<" + name + ">") + name.size() + 2;
    page.erase(a, page.find("</" + name + ">") - a);
  }
  return page;
}

Section section(const std::string& experiment) {
  Series jpo{.label = "JPO <&>",
             .method = "jpo",
             .x = {1, 2, 4},
             .y = {1, 0.5, kNaN},
             .lo = {0.5, 0.2, 0},
             .hi = {2, 1, 1},
             .markers = true};
  Series bfgs{.label = "BFGS", .method = "bfgs", .x = {1, 4}, .y = {1, 1}};
  Series end{.method = "bfgs", .x = {4}, .y = {1}, .line = false};
  Panel panel{.title = "p & q", .x_label = "n", .y_label = "loss"};
  panel.series = {jpo, bfgs, end};
  return {
      .experiment = experiment,
      .title = "Toy <b>",
      .paper = "someone2020",
      .tables = {{.id = "table1",
                  .title = "Times",
                  .where = "Table 1",
                  .unit = "s",
                  .digits = 2,
                  .corner = "method",
                  .columns = {"a", "b"},
                  .rows = {{.label = "JPO",
                            .cells = {{.ours = 1.5,
                                       .spread = 0.25,
                                       .paper = 2.25,
                                       .paper_spread = 0.75},
                                      {.ours = 1e-5}}},
                           {.label = "x < y", .cells = {{.text = "not run"}}},
                           {.label = "GD", .cells = {{}, {.ours = 2}}}}}},
      .figures = {{.id = "fig1",
                   .title = "F",
                   .where = "Fig. 1",
                   .panels = {panel, panel},
                   .note = "note > this"},
                  {.id = "fig2", .title = "Empty"}},
      .claims = {{.id = "R1",
                  .says = "a < b & \"c\"",
                  .from = "quick",
                  .gates = true,
                  .verdict = Verdict::reproduced,
                  .evidence = "0.98 >= 0.5",
                  .origin = Origin::paper,
                  .where = "Sec. <2>",
                  .note = "against Table 3"},
                 {.id = "R2",
                  .says = "c",
                  .gates = true,
                  .verdict = Verdict::not_reproduced},
                 {.id = "R3", .says = "d", .from = "paper"}}};
}

nlohmann::ordered_json provenance() {
  return {{"profile", "quick"},
          {"date", "2024-01-02T03:04:05Z"},
          {"compiler_flags", "-O3 <&>"},
          {"papers", {"jpo: A. Author & B. Author: A title."}},
          {"options", {{"threads", 1}}}};
}

std::string page() {
  // Names that differ only in what no id can hold.
  return report_html({section("jpo/toy"), section("jpo-toy")}, provenance());
}

TEST(ReportHtml, IsWellFormed) {
  EXPECT_EQ(xml_error(markup(page())), "");
  EXPECT_EQ(xml_error(markup(report_html({}, nullptr))), "");
}

TEST(ReportHtml, AsksNobodyForAnything) {
  const std::string text = page();
  EXPECT_EQ(count(text, "://"), 0U);
  EXPECT_EQ(count(text, "src="), 0U);
  EXPECT_EQ(count(text, "@import"), 0U);
  EXPECT_EQ(count(text, "<link"), 0U);
  EXPECT_EQ(count(text, "default-src 'none'; img-src data:;"), 1U);
  static const std::regex kUrl("url\\(([^)]*)\\)");
  for (std::sregex_iterator at(text.begin(), text.end(), kUrl), end; at != end;
       ++at) {
    EXPECT_EQ((*at)[1].str().front(), '#');
  }
}

TEST(ReportHtml, IdsAreUniqueAndLinksArrive) {
  const std::string text = page();
  static const std::regex kId(" id=\"([^\"]*)\""), kHref(
                                                       "href=\"#([^\"]*)\"|"
                                                       "url\\(#([^)]*)\\)|"
                                                       "labelledby=\"([^\"]"
                                                       "*)\"");
  std::set<std::string> ids;
  for (std::sregex_iterator at(text.begin(), text.end(), kId), end; at != end;
       ++at) {
    EXPECT_TRUE(ids.insert((*at)[1]).second) << (*at)[1];
  }
  std::size_t links = 0;
  for (std::sregex_iterator at(text.begin(), text.end(), kHref), end; at != end;
       ++at, ++links) {
    const std::string to = (*at)[1].str() + (*at)[2].str() + (*at)[3].str();
    EXPECT_TRUE(ids.contains(to)) << to;
  }
  EXPECT_GT(links, 20U);
  for (const char* id : {"jpo-toy",
                         "jpo-toy-R1",
                         "jpo-toy-R3",
                         "jpo-toy-table1",
                         "jpo-toy-fig1",
                         "jpo-toy-fig2",
                         "jpo-toy-2",
                         "jpo-toy-R1-2",
                         "jpo-toy-fig1-2",
                         "provenance"}) {
    EXPECT_TRUE(ids.contains(id)) << id;
  }
}

TEST(ReportHtml, CountsClaimsAndShowsEvidence) {
  const std::string text = page();
  EXPECT_NE(between(text, "<header", "</header>")
                .find("A. Author &amp; B. Author: A title."),
            text.npos);
  EXPECT_EQ(count(text, "<strong>2</strong> reproduced"), 1U);
  // The suite's ranges do not count as what the papers say.
  EXPECT_EQ(count(text, "<strong>0</strong> not reproduced"), 1U);
  EXPECT_EQ(count(text, "<strong>0</strong> not judged"), 1U);
  EXPECT_EQ(
      count(text, "0 reproduced, 2 not reproduced, 2 not judged, 0 reported"),
      1U);
  EXPECT_EQ(count(text, "not met: 2.</p>"), 1U);
  const std::string row = between(text, "<tr id=\"jpo-toy-R1\">", "</tr>");
  EXPECT_NE(row.find("✓ reproduced"), row.npos);
  EXPECT_NE(row.find("0.98 &gt;= 0.5"), row.npos);
  EXPECT_NE(row.find("Sec. &lt;2&gt; · • gating"), row.npos);
  EXPECT_NE(row.find("against Table 3"), row.npos);
  EXPECT_NE(between(text, "<tr id=\"jpo-toy-R3\">", "</tr>")
                .find("not gating, judged from profile paper"),
            row.npos);
}

TEST(ReportHtml, TellsWorkMadeAndSaved) {
  Section own = section("jpo/toy");
  EXPECT_EQ(report_html({own}, provenance()).find("Work: "), std::string::npos);
  own.work = Counts();
  (*own.work)[Counter::forward] = 5;
  (*own.work)[Counter::skipped_vjp] = 7;
  own.work->forget(Counter::skipped_terms);
  EXPECT_EQ(count(report_html({own}, provenance()),
                  "<p class=\"remark\">Work: 5 simulations. Saved: 7 "
                  "gradients known to be zero. Not counted: "
                  "<code>skipped_terms</code>.</p>\n"),
            1U);
}

TEST(ReportHtml, FiguresComeFirstThenStatementsTablesAndWork) {
  Section own = section("jpo/toy");
  own.standing = "JPO ranks best";
  own.work = Counts();
  (*own.work)[Counter::forward] = 5;
  const std::string page =
      section_page_html(own, provenance(), Palette({own}), {});
  std::size_t last = 0;
  for (const char* part : {"All experiments",
                           "<p class=\"answer\">JPO ranks best.</p>",
                           "<p class=\"counts\">The paper's statements: ",
                           "profile quick · 2024-01-02",
                           "<figure id=\"jpo-toy-fig1\">",
                           "<div id=\"jpo-toy-statements\">",
                           "<div class=\"table\" id=\"jpo-toy-table1\">",
                           "Work: 5 simulations.",
                           "<dt>compiler flags</dt>"}) {
    const auto at = page.find(part, last);
    EXPECT_NE(at, page.npos) << part;
    last = at == page.npos ? last : at;
  }
}

TEST(ReportHtml, FiguresAreInThePapersOrder) {
  const auto figure = [](const char* where) {
    return Figure{.id = where, .title = where, .where = where};
  };
  using Order = std::vector<std::size_t>;
  EXPECT_EQ(order_of({figure("Fig. 11"),
                      figure(""),
                      figure("Fig. 4b, right"),
                      figure("Figs. 4a, 11"),
                      figure("Table 2"),
                      figure("Fig. 4b")}),
            (Order{3, 2, 5, 0, 1, 4}));
  Figure drawn = figure("Fig. 20");
  drawn.picture = true;
  EXPECT_EQ(order_of({figure("Fig. 1"), drawn}), (Order{1, 0}));
  Section own = section("jpo/toy");
  own.figures = {figure("Fig. 9"), figure("Fig. 2")};
  const std::string page = report_html({own}, provenance());
  EXPECT_LT(page.find("<figure id=\"jpo-toy-Fig--2\">"),
            page.find("<figure id=\"jpo-toy-Fig--9\">"));
}

TEST(ReportHtml, APictureWithoutPanelsSaysWhy) {
  Section own = section("jpo/toy");
  own.figures = {{.id = "picture",
                  .title = "P",
                  .note = "Unknowns are not stored.",
                  .picture = true}};
  const std::string page = report_html({own}, provenance());
  const std::string figure = between(
      page, "<figure id=\"jpo-toy-picture\" class=\"picture\">", "</figure>");
  EXPECT_NE(figure.find("Unknowns are not stored."), figure.npos);
  EXPECT_EQ(figure.find("not run"), figure.npos);
  EXPECT_EQ(figure.find("<svg"), figure.npos);
}

TEST(ReportHtml, TablesPutThePaperBeside) {
  const std::string table = between(
      page(), "<div class=\"table\" id=\"jpo-toy-table1\">", "</table>");
  EXPECT_NE(table.find("<p class=\"caption\" id=\"jpo-toy-table1-caption\">"),
            table.npos);
  EXPECT_NE(table.find("Table 1 · Times [s]"), table.npos);
  EXPECT_NE(table.find("<td>1.50</td><td class=\"spread\">± 0.25</td>"
                       "<td class=\"paper\">2.25</td>"
                       "<td class=\"spread\">± 0.75</td><td>1.0·10⁻⁵</td>"),
            table.npos)
      << table;
  EXPECT_NE(table.find("<td class=\"nil\" colspan=\"2\">not run</td>"),
            table.npos);
  EXPECT_NE(table.find("<th scope=\"row\">x &lt; y</th>"), table.npos);
  // Each row as wide as the head: label, 2 + 2 for a, 1 for b.
  std::size_t rows = 0;
  const std::string body = table.substr(table.find("<tbody>"));
  for (auto at = body.find("<tr>"); at != body.npos;
       at = body.find("<tr>", at + 1)) {
    const std::string row = body.substr(at, body.find("</tr>", at) - at);
    EXPECT_EQ(count(row, "<td") + count(row, "colspan=\"2\""), 5U) << row;
    ++rows;
  }
  EXPECT_EQ(rows, 3U);
}

TEST(ReportHtml, ColumnsAndRowsThatWereNotRunAreWords) {
  const Cell none{.text = "not run"};
  Section s{.experiment = "e", .title = "E"};
  s.tables = {
      {.id = "t",
       .columns = {"a", "b", "c"},
       .rows = {{.label = "x", .cells = {{.ours = 1}, none, none}},
                {.label = "y",
                 .cells = {none, none, {.paper = 3, .text = "not run"}}},
                {.label = "z", .cells = {none, none, none}}}},
      {.id = "nothing",
       .columns = {"a"},
       .rows = {{.label = "x", .cells = {none}}}}};
  const std::string text = report_html({s}, nullptr);
  EXPECT_NE(text.find("<p class=\"nil\">not run: b; z</p>"), text.npos);
  EXPECT_EQ(text.find("<th scope=\"row\">z</th>"), text.npos);
  EXPECT_NE(text.find("<th scope=\"row\">y</th>"), text.npos)
      << "the paper has a number there";
  const std::string empty =
      between(text, "<div class=\"table\" id=\"e-nothing\">", "</div>");
  EXPECT_NE(empty.find(">not run<"), empty.npos);
  EXPECT_EQ(empty.find("<table"), empty.npos);
}

TEST(ReportHtml, PanelsThatShowOneNumberAreWords) {
  const Series flat{.label = "a", .method = "a", .x = {1, 2}, .y = {0.5, 0.5}},
      falls{.label = "a", .method = "a", .x = {1, 2}, .y = {1, 0.5}},
      none{.label = "b", .method = "b"},
      half{.label = "half",
           .method = "h",
           .x = {1, 2},
           .y = {1, 1},
           .dashed = true};
  Section s{.experiment = "e", .title = "E"};
  s.figures = {{.id = "f",
                .panels = {{.title = "P", .y_label = "share", .series = {flat}},
                           {.title = "Q", .series = {falls, none}},
                           {.title = "R", .series = {none, half}}}}};
  const std::string figure =
      between(report_html({s}, nullptr), "<figure id=\"e-f\">", "</figure>");
  EXPECT_EQ(count(figure, "<svg viewBox"), 1U + 1U) << "a panel and its legend";
  EXPECT_NE(figure.find("P: share is 0.5 throughout"), figure.npos);
  EXPECT_NE(figure.find("not run: R; not run: b"), figure.npos)
      << "half alone is a line of reference";
}

TEST(ReportHtml, FlatTablesAreTurned) {
  Section s{.experiment = "e", .title = "E"};
  s.tables = {{.id = "t",
               .title = "T",
               .columns = {"a", "b", "c", "d"},
               .rows = {{.label = "only",
                         .cells = {{.ours = 1}, {.ours = 2}, {.ours = 3}}}}}};
  const std::string text = report_html({s}, nullptr);
  EXPECT_NE(text.find("<th scope=\"row\">b</th><td>2.0</td>"), text.npos);
  EXPECT_NE(text.find("<th scope=\"row\">d</th><td>–</td>"), text.npos);
}

TEST(ReportHtml, FiguresShareOneStyleAndMarkTheirSeries) {
  const std::string text = page();
  EXPECT_EQ(count(text, "<style"), 1U);
  const std::string figure =
      between(text, "<figure id=\"jpo-toy-fig1\">", "</figure>");
  EXPECT_EQ(count(figure, "<svg viewBox=\"0 0 430 290\" role=\"img\">"), 2U);
  EXPECT_EQ(count(figure, "<title>p &amp; q</title>"), 2U);
  EXPECT_EQ(count(figure, "<li data-k="), 2U);
  EXPECT_EQ(count(figure, "JPO &lt;&amp;&gt;</li>"), 1U);
  EXPECT_EQ(count(figure, "data-x=\""), 2U);
  // What there is of line, error bars and marker; the end of BFGS, which has no
  // label, goes with BFGS.
  EXPECT_EQ(count(figure, "<g class=\"k k0\""), 4U);
  EXPECT_EQ(count(figure, "<g class=\"k k1\""), 4U);
  EXPECT_NE(figure.find("note &gt; this"), figure.npos);
  EXPECT_NE(between(text, "<figure id=\"jpo-toy-fig2\">", "</figure>")
                .find("not run"),
            text.npos);
}

TEST(ReportHtml, FilmsSayHowManyPanelsAreAMoment) {
  Section films = section("jpo/film");
  films.figures = {{.id = "film", .panels = {4, Panel{}}, .moment = 2},
                   {.id = "still", .panels = {4, Panel{}}}};
  const std::string text = report_html({films}, provenance());
  EXPECT_EQ(count(text, "data-moment=\"2\""), 1U);
  EXPECT_EQ(count(text, "data-moment"), 2U);  // and once in the script
  // Without the script everything can be seen.
  EXPECT_EQ(count(between(text, "<figure id=\"jpo-film-film\">", "</figure>"),
                  "<svg viewBox"),
            4U);
}

TEST(ReportHtml, NothingIsTakenForMarkup) {
  const std::string text = page();
  EXPECT_EQ(count(text, "<b>"), 0U);
  EXPECT_EQ(count(text, "<&>"), 0U);
  EXPECT_NE(text.find("Toy &lt;b&gt;"), text.npos);
  EXPECT_NE(text.find("a &lt; b &amp; &quot;c&quot;"), text.npos);
}

TEST(ReportHtml, ProvenanceInTheFooter) {
  const std::string footer = between(page(), "<footer", "</footer>");
  EXPECT_NE(footer.find("<dt>compiler flags</dt><dd>-O3 &lt;&amp;&gt;</dd>"),
            footer.npos);
  EXPECT_NE(footer.find("&quot;threads&quot;: 1"), footer.npos);
}

TEST(ReportHtml, SameBytesAndSmall) {
  EXPECT_EQ(page(), page());
  Section large = section("jpo/large");
  Figure figure{.id = "curves", .title = "Curves", .columns = 4};
  for (int p = 0; p < 16; ++p) {
    Panel panel{.x_log = true, .y_log = true};
    for (const char* method : {"bfgs", "gd", "jpo", "supervised", "na"}) {
      Series s{.label = method, .method = method};
      for (int i = 1; i <= 100; ++i) {
        s.x.push_back(i);
        s.y.push_back(1.0 / i);
      }
      panel.series.push_back(std::move(s));
    }
    figure.panels.push_back(std::move(panel));
  }
  large.figures.push_back(std::move(figure));
  EXPECT_LT(report_html({large}, provenance()).size(), 250'000U);
}

TEST(ReportHtml, WhatClaimsNothingCountsNothing) {
  const Section section{.experiment = "history", .title = "History"};
  const std::string page = report_html({section}, {});
  EXPECT_EQ(page.find("class=\"totals\""), page.npos);
  EXPECT_EQ(page.find("class=\"overview\""), page.npos);
}

}  // namespace
}  // namespace physinv
