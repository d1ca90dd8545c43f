/// Writes a campaign's report: one page to read it in a browser, an overview in
/// Markdown with one folder per experiment, and everything again as JSON for
/// programs.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "suite/results/report_model.h"
#include "suite/results/verdict_words.h"

namespace physinv {

/// Of claims.json and digest.json; 2: verdicts in the words of verdicts.md.
inline constexpr int kClaimsVersion = 2;

/// How many claims of an origin have which verdict.
using Tally = VerdictCounts;
Tally tally(const Section& section, Origin origin);
Tally tally(const std::vector<Section>& sections, Origin origin);
/// "12 reproduced, 3 not reproduced, 4 not judged, 1 reported"
std::string tally_text(const Tally& tally);

nlohmann::ordered_json to_json(const Figure& figure);
nlohmann::ordered_json to_json(const ClaimResult& claim);
/// What `to_json` made, with or without a cause; std::runtime_error if it is
/// none.
ClaimResult claim_from(const nlohmann::ordered_json& claim);

/// A file's or folder's name of an experiment, jpo/billiards -> jpo-billiards:
/// one of its own, which needs no escapes.
std::string folder_of(std::string_view experiment);

/// A group of experiments: those whose name begins with the key.
struct Group {
  std::string key;    ///< jpo
  std::string title;  ///< of the paper
  std::string text;   ///< authors, venue
  std::string link;   ///< where to read it; may be empty
};

/// A figure that was drawn before.
struct Picture {
  std::string title, svg, note;
};

/// How a report is cut into pages.
struct Pages {
  bool one_file = true;       ///< index.html has everything
  std::vector<Group> groups;  ///< of the index, in order
  std::size_t front = 0;      ///< so many sections are on the index, whole
  /// By experiment, below its other figures.
  std::map<std::string, std::vector<Picture>> pictures = {};
};

/// Of an experiment; empty if there are none.
std::vector<Picture> pictures_of(const Pages& pages, const Section& section);

/// Files below `dir`, where jpo/billiards becomes jpo-billiards:
///   index.html, report.md, and with several pages <experiment>/index.html
///   and, where there is a figure, <experiment>/card.svg,
///   claims.json ({provenance, sections: [{..., claims}]}),
///   <experiment>/tables/<id>.{json,csv,md},
///   <experiment>/figures/<id>.{json,csv,vl.json,svg}; vl is Vega-Lite.
/// Each file appears whole or not at all. Returns what was written, in order.
/// Same sections and provenance, same bytes.
/// Throws StoreError if a file cannot be written.
std::vector<std::filesystem::path> write_report(
    const std::filesystem::path& dir,
    const std::vector<Section>& sections,
    const nlohmann::ordered_json& provenance,
    const Pages& pages = {});

/// The overview alone, with links relative to report.md.
std::string report_markdown(const std::vector<Section>& sections,
                            const nlohmann::ordered_json& provenance);

/// Claims and verdicts for a terminal.
std::string render_claims_text(const std::vector<Section>& sections,
                               std::size_t width);

}  // namespace physinv
