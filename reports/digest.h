/// The digest of a campaign: what a table of results needs, as one JSON file
/// that is small enough to be kept with the sources.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

/// {provenance, sections: [{experiment, title, paper, claims, tables,
/// figures}]}; a table is the text of its Markdown, figures are those that
/// `kept_figures` has.
nlohmann::ordered_json digest_json(const std::vector<Section>& sections,
                                   const nlohmann::ordered_json& provenance);

/// The papers' figures in a campaign as SVG files, by the name that the digest
/// gives them below the campaign's folder: "jpo-billiards-fig11.svg". Pictures
/// of fields and films are too large to be kept with the sources.
std::map<std::string, std::string> kept_figures(
    const std::vector<Section>& sections);

/// The command that makes such a campaign, from the options that its context
/// holds: "./bench --profile=paper --filter=jpo/".
std::string campaign_command(const nlohmann::ordered_json& provenance);

struct NamedDigest {
  std::string name;  ///< folder of the campaign
  nlohmann::ordered_json digest;
  std::map<std::string, double> cpu_seconds = {};  ///< by experiment
  /// As it was published, if its claims were judged anew since.
  nlohmann::ordered_json published = {};
};

}  // namespace physinv
