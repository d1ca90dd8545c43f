/// Parts of a panel in Vega-Lite.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "suite/results/report_model.h"

namespace physinv {

/// A quantitative channel as long as its data, so that no decade is empty.
nlohmann::ordered_json vega_axis(const char* field,
                                 const std::string& title,
                                 bool log);

/// A layer of rectangles. Values that cannot be shown are left out; places that
/// a logarithmic axis cannot show, such as 0, are names next to each other.
void add_vega_field(nlohmann::ordered_json& layers,
                    const Field2D& field,
                    const Panel& panel);

/// A layer of rules, the longest as long as the arrows say.
void add_vega_arrows(nlohmann::ordered_json& layers,
                     const Arrows& arrows,
                     const Panel& panel);

}  // namespace physinv
