/// Pieces of the HTML report. All text arguments are plain and are escaped.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reports/anchors.h"
#include "reports/palette.h"
#include "reports/report.h"
#include "suite/results/report_model.h"
#include "suite/results/verdict_words.h"

namespace physinv {

extern const std::string_view kPageCss, kPageJs;

/// Text as HTML.
std::string html(std::string_view text);
/// Words where a table or figure has nothing to show; empty as they are.
std::string nil_html(const std::string& words);

/// "Fig. 11 · Title" as a link to its own place.
std::string caption_html(const std::string& id,
                         std::string_view where,
                         std::string_view title);

/// Our numbers and, where there are some, the paper's side by side; spreads are
/// separate columns, so that digits are below each other. A table that is wide
/// and flat is turned; columns and rows that were not run are words below it.
std::string table_html(const Table& table, const std::string& id);

/// "Table 4 · Title".
std::string name_of(std::string_view where, std::string_view title);

/// Class of a verdict in the page's style sheet.
std::string_view css_of(Verdict verdict);

/// "✓ 3 reproduced, ✗ 1 not reproduced"; nothing where nothing is decided.
std::string verdicts_html(const VerdictCounts& counts);

/// The same with those that are not judged.
std::string counts_html(const VerdictCounts& counts);

/// What is on a page; all of it is HTML.
struct PageParts {
  std::string title;  ///< plain, of the window
  std::string header, contents, main, footer;
  bool pictures = false;  ///< shows files of its folder
};
/// A page that needs nothing but itself.
std::string page_html(const PageParts& parts);

/// Counts of statements by verdict, one row per section.
std::string overview_html(const std::vector<Section>& sections,
                          const std::vector<Anchors>& anchors);
/// Links to the sections' claims, tables and figures.
std::string contents_html(const std::vector<Section>& sections,
                          const std::vector<Anchors>& anchors);
/// What the page is called: pages that are no report of reproductions bring
/// their own.
std::string heading_of(const nlohmann::ordered_json& provenance);

/// Profile, date and processor, as far as they are known.
std::string summary_html(const nlohmann::ordered_json& provenance);
/// All that is known of a campaign.
std::string provenance_html(const nlohmann::ordered_json& provenance);
/// A page of one experiment: claims, tables and figures, with links to their
/// data, which are in the page's folder, and to the index above it.
std::string section_page_html(const Section& section,
                              const nlohmann::ordered_json& provenance,
                              const Palette& palette,
                              const std::vector<Picture>& pictures = {});

/// A card of the index: picture, if there is one, which shows this; one problem
/// before and after, if it is drawn; title, answer, verdicts. The title leads
/// to the page of the experiment.
std::string card_html(const Section& section,
                      const std::string& folder,
                      const std::optional<std::string>& picture);

/// A paper, or another group.
struct Part {
  Group group;
  std::vector<const Section*> sections;
};
constexpr const char *kDeviations = "Statements that do not hold as printed",
                     *kMeasured = "Measured and published numbers";
/// Sections `deviations` and `numbers` of the index: by paper, statements that
/// do not hold with what was measured and why; numbers that papers print next
/// to those measured, and how many statements are not judged.
std::string chapters_html(const std::vector<Part>& parts);

/// What surrounds the text of a page.
struct Beside {
  /// Of the data of tables and figures, from the page; nothing: not linked.
  std::optional<std::string> folder = {};
  std::string command = {};   ///< what makes them
  std::string about = {};     ///< HTML below the section's head
  std::string pictures = {};  ///< HTML below its figures
};
/// The part of a page that shows an experiment: how its methods compare and the
/// counts of verdicts; figures in the paper's order; claims with links to the
/// tables and figures of the places they name, and back; tables; the work.
std::string section_html(const Section& section,
                         const Anchors& anchors,
                         const Palette& palette,
                         const Beside& beside);

/// The command that makes a section again; empty if the profile is not known.
std::string command_of(const Section& section,
                       const nlohmann::ordered_json& provenance);

/// Panels as in the SVG file, each a separate drawing so that they flow on
/// narrow screens; title, legend and note are HTML.
std::string figure_html(const Figure& figure,
                        const std::string& id,
                        const Palette& report);

}  // namespace physinv
