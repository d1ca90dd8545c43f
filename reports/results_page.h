/// The pages of published campaigns: one that has every statement once, and one
/// for each experiment.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "reports/digest.h"

namespace physinv {

/// Where the pages link to, without a slash at the end.
struct ResultsLinks {
  std::string pages = "docs/results";                 ///< from the overview
  std::string overview = "../../RESULTS.md";          ///< from a page
  std::string campaigns = "../../reports/campaigns";  ///< from a page
};

/// Markdown: how many of each paper's claims are reproduced, then by paper each
/// of its statements once, what fails first, with what was asked and measured,
/// its cause and the campaign; last the suite's ranges that do not hold. The
/// newest campaign that decided counts. std::runtime_error if a digest lacks
/// what it should have.
std::string results_markdown(const std::vector<NamedDigest>& campaigns,
                             const ResultsLinks& links = {});

/// By the name of the file, jpo-billiards.md: claims with all that was measured
/// for them, then by campaign, the newest first, its command, machine, build
/// and date, tables and figures. std::runtime_error as above.
std::map<std::string, std::string> experiment_pages(
    const std::vector<NamedDigest>& campaigns, const ResultsLinks& links = {});

/// Markdown: all of the papers' claims as campaigns were published before
/// claims had causes, and as they stand now with cause, deciding campaign and
/// its runs; then the CPU-hours by paper, machine and revision. Empty if no
/// campaign is so old. std::runtime_error as above.
inline constexpr const char* kAuditPage = "audit.md";
std::string audit_markdown(const std::vector<NamedDigest>& campaigns,
                           const ResultsLinks& links = {});

/// How each of these pages begins, after its title.
inline constexpr const char* kWrittenByResults = "Written by `./bench results`";

}  // namespace physinv
