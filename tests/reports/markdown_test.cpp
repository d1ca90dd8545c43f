#include "suite/results/markdown.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "reports/report.h"
#include "reports/results_page.h"
#include "reports/tables.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

/// What a name in a file could do to a page.
constexpr const char* kHostile =
    "a|b`c`<img src=x>[d](e)*f*\n\n# g\x1b[2J\\|h &lt; i";
constexpr const char* kEscaped =
    "a\\|b\\`c\\`&lt;img src=x>\\[d\\](e)\\*f\\*  # g \\[2J\\\\\\|h "
    "&amp;lt; i";

/// Pipes that end a cell.
std::size_t bars(const std::string& line) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\\')
      ++i;
    else
      count += line[i] == '|';
  }
  return count;
}

/// A run of backticks, and what it opens up to one of the same length, go: code
/// shows whatever it holds.
std::string without_code(const std::string& page) {
  std::string out;
  for (std::size_t at = 0; at < page.size();) {
    const bool escape = page[at] == '\\';
    const std::size_t run =
        std::min(page.find_first_not_of('`', at), page.size()) - at;
    if (run == 0) {
      out += page.substr(at, escape ? 2 : 1);
      at += escape ? 2 : 1;
      continue;
    }
    const std::string fence(run, '`');
    std::size_t end = page.find(fence, at + run);
    while (end != page.npos && page.compare(end + run, 1, "`") == 0)
      end = page.find(fence, page.find_first_not_of('`', end));
    EXPECT_NE(end, page.npos);
    EXPECT_EQ(page.substr(at, end - at).find('\n'), page.npos);
    at = end + run;
  }
  return out;
}

/// Nothing of the name but its words is left, and tables keep their columns.
void expect_tame(const std::string& whole) {
  const std::string page = without_code(whole);
  EXPECT_EQ(page.find("<img"), page.npos);
  EXPECT_EQ(page.find("[d]("), page.npos);
  EXPECT_EQ(page.find("\n# g"), page.npos);
  EXPECT_EQ(page.find('\x1b'), page.npos);
  EXPECT_NE(page.find("img src=x"), page.npos);
  std::istringstream lines(page);
  std::size_t columns = 0;
  for (std::string line; std::getline(lines, line);) {
    const bool row = line.starts_with('|');
    if (row && columns > 0) {
      EXPECT_EQ(bars(line), columns) << line;
    }
    columns = row ? bars(line) : 0;
  }
}

Section hostile_section() {
  const std::string name = kHostile;
  return {.experiment = name,
          .title = name,
          .paper = name,
          .tables = {{.id = "t",
                      .title = name,
                      .where = name,
                      .unit = name,
                      .corner = name,
                      .columns = {name, "x"},
                      .rows = {{name, {{.text = name}, {.ours = 1.0}}}},
                      .note = name}},
          .figures = {{.id = "f", .title = name, .note = name}},
          .claims = {{.id = name,
                      .says = name,
                      .from = name,
                      .verdict = Verdict::reproduced,
                      .evidence = name,
                      .origin = Origin::paper,
                      .where = name,
                      .note = name},
                     {.id = name, .says = name, .from = name}}};
}

TEST(Markdown, ShowsAnyTextAsItIs) {
  EXPECT_EQ(markdown(kHostile), kEscaped);
  EXPECT_EQ(markdown("jpo/billiards/na n=64 1.0e-12 snake_case"),
            "jpo/billiards/na n=64 1.0e-12 snake_case");
  EXPECT_EQ(markdown("_a_ ±é"), "\\_a\\_ ±é");
  EXPECT_EQ(markdown("# > 0.5"), "\\# > 0.5");
  EXPECT_EQ(markdown("a <= 1 & b < 2 </p><!--<?&#60;"),
            "a <= 1 & b < 2 &lt;/p>&lt;!--&lt;?&amp;#60;");
  EXPECT_EQ(markdown_code("a b"), "`a b`");
  EXPECT_EQ(markdown_code("a``b\n`"), "``` a``b ` ```");
  EXPECT_EQ(markdown_code(""), "`  `");
}

TEST(Markdown, NamesAreNoStructureOfTables) {
  const Table table = hostile_section().tables.front();
  expect_tame(to_markdown(table));
  EXPECT_EQ(render_text(table, 80).find('\x1b'), std::string::npos);
}

TEST(Markdown, NamesAreNoStructureOfReports) {
  expect_tame(report_markdown({hostile_section()}, {{kHostile, kHostile}}));
}

TEST(Markdown, NamesAreNoStructureOfThePageOfResults) {
  const nlohmann::ordered_json origin{{"profile", kHostile},
                                      {"compiler", kHostile},
                                      {"options", {{"filter", {kHostile}}}},
                                      {"papers", {kHostile}}};
  const std::vector<NamedDigest> all{
      {kHostile, digest_json({hostile_section()}, origin)}};
  expect_tame(results_markdown(all,
                               {{.key = kHostile,
                                 .title = kHostile,
                                 .question = kHostile,
                                 .main_claims = {{kHostile, kHostile}}}}));
  expect_tame(checks_markdown(all));
  for (const auto& [name, page] : experiment_pages(all)) expect_tame(page);
}

TEST(Markdown, ReportsStayInTheirFolder) {
  const fs::path root = fs::path(testing::TempDir()) / "physinv_report_names";
  fs::remove_all(root);
  for (const char* name : {"..", ".", "", "../../x", "a/../b", "/etc", "c\n"}) {
    Section section = hostile_section();
    section.experiment = name;
    for (const auto& file : write_report(root / "in", {section}, {})) {
      const auto inside = file.lexically_normal().lexically_relative(
          (root / "in").lexically_normal());
      EXPECT_NE(*inside.begin(), "..") << name << ": " << file;
    }
  }
  std::size_t entries = 0;
  for (const auto& entry : fs::directory_iterator(root)) {
    EXPECT_EQ(entry.path().filename(), "in");
    ++entries;
  }
  EXPECT_EQ(entries, 1U);
  fs::remove_all(root);
}

}  // namespace
}  // namespace physinv
