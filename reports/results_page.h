/// The pages of published campaigns: an overview of the papers' statements, the
/// regression checks, and a page for each experiment.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "reports/digest.h"
#include "suite/results/published.h"

namespace physinv {

/// Where the pages link to, without a slash at the end.
struct ResultsLinks {
  std::string pages = "docs/results";                 ///< from the overview
  std::string overview = "../../RESULTS.md";          ///< from a page
  std::string campaigns = "../../reports/campaigns";  ///< from a page
};

/// Markdown: the answer to each paper's main question (its main claims), how
/// many of its statements are reproduced, those that are not with what was
/// measured and the cause, those that are undecided, links to the experiments'
/// pages, and what the campaigns took. The newest campaign that decided a claim
/// counts. std::runtime_error if a digest lacks what it should have.
std::string results_markdown(const std::vector<NamedDigest>& campaigns,
                             const std::vector<Publication>& publications = {},
                             const ResultsLinks& links = {});

/// Markdown, in the folder of the experiments' pages: how many regression
/// checks hold, and those that do not. std::runtime_error as above.
inline constexpr const char* kChecksPage = "regression-checks.md";
std::string checks_markdown(const std::vector<NamedDigest>& campaigns,
                            const ResultsLinks& links = {});

/// By the name of the file, jpo-billiards.md: claims with all that was measured
/// for them, then by campaign, the newest first, its command, machine, build
/// and date, tables and figures. std::runtime_error as above.
std::map<std::string, std::string> experiment_pages(
    const std::vector<NamedDigest>& campaigns, const ResultsLinks& links = {});

/// How each of these pages begins, after its title.
inline constexpr const char* kWrittenByResults = "Written by `./bench results`";

}  // namespace physinv
