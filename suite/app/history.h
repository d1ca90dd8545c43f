/// The gate's numbers over the commits of this checkout.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

inline constexpr const char* kGateBaseline = "reports/baselines/smoke.txt";

struct GitHistory {
  /// Of the versions of a baseline that git has, oldest first; nothing without
  /// git or of fewer than two.
  std::vector<Section> sections;
  /// What git says where it fails, and where a shallow clone ends; empty if it
  /// has all.
  std::string lacks;
};
GitHistory history_of_git(const std::string& baseline);

/// What their pages say of themselves.
nlohmann::ordered_json history_origin(const std::string& baseline);

}  // namespace physinv
