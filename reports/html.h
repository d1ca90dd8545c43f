/// The whole report as one HTML page that needs nothing but itself: style,
/// script and figures are inside, and its policy forbids it to fetch anything.
/// Everything can be read without the script, which adds read-outs of points,
/// switching series by the legend, and the choice of light or dark.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

/// Same sections and provenance, same bytes. Ids of claims, tables and
/// figures are <experiment>-<id> with '-' for what is no letter or digit;
/// a number follows where that would repeat.
std::string report_html(const std::vector<Section>& sections,
                        const nlohmann::ordered_json& provenance);

}  // namespace physinv
