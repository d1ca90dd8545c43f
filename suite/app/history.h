/// The gate's numbers over the commits of this checkout.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

inline constexpr const char* kGateBaseline = "reports/baselines/smoke.txt";

/// Of the versions of a baseline that git has, oldest first; nothing without
/// git or of fewer than two.
std::vector<Section> history_sections(const std::string& baseline);

/// What their pages say of themselves.
nlohmann::ordered_json history_origin(const std::string& baseline);

}  // namespace physinv
