/// The digest of a campaign: what a table of results needs, as one JSON file
/// that is small enough to be kept with the sources.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "suite/results/report_model.h"
#include "suite/store/record.h"

namespace physinv {

/// {provenance, sections: [{experiment, title, paper, claims, tables,
/// figures}]}; tables by digest_tables.h, figures are those that `kept_figures`
/// has.
nlohmann::ordered_json digest_json(const std::vector<Section>& sections,
                                   const nlohmann::ordered_json& provenance);

/// What a digest's pages show: claims and tables. There are no figures;
/// std::runtime_error if it is not a digest.
std::vector<Section> sections_of(const nlohmann::ordered_json& digest);

/// The papers' figures in a campaign as SVG files, by the name that the digest
/// gives them below the campaign's folder: "jpo-billiards-fig11.svg". Pictures
/// of fields and films are too large to be kept with the sources.
std::map<std::string, std::string> kept_figures(
    const std::vector<Section>& sections);

/// The command that runs a published campaign again.
std::string campaign_command(const std::string& name);

struct NamedDigest {
  std::string name;  ///< folder of the campaign
  nlohmann::ordered_json digest;
  std::map<std::string, double> cpu_seconds = {};  ///< by experiment
  std::map<std::string, Counts> work = {};         ///< made and saved, alike
};

/// With the work of each.
std::vector<Section> sections_of(const NamedDigest& campaign);

}  // namespace physinv
