/// The digest of a campaign: what a table of results needs, as one JSON file
/// that is small enough to be kept with the sources, and the page that shows
/// many of them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

/// {provenance, sections: [{experiment, title, paper, claims, tables}]}; a
/// table is the text of its Markdown.
nlohmann::ordered_json digest_json(const std::vector<Section>& sections,
                                   const nlohmann::ordered_json& provenance);

/// What a digest's pages show: claims as they are, tables by their words. There
/// are no figures; std::runtime_error if it is no digest.
std::vector<Section> sections_of(const nlohmann::ordered_json& digest);
/// A table as to_markdown wrote it, with words in place of numbers.
Table table_of(const std::string& markdown, std::string id);

/// The command that makes such a campaign, from the options that its context
/// holds: "./bench --profile=paper --filter=jpo/".
std::string campaign_command(const nlohmann::ordered_json& provenance);

struct NamedDigest {
  std::string name;  ///< folder of the campaign
  nlohmann::ordered_json digest;
};

/// Markdown: how many of each paper's claims are reproduced, then every
/// campaign with its machine, build, date and command, its claims and tables.
/// Where campaigns judge the same claim, the last one that decided it counts,
/// and what was decided before what was only reported. std::runtime_error if a
/// digest lacks what it should have.
std::string results_markdown(const std::vector<NamedDigest>& campaigns);

}  // namespace physinv
