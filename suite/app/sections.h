/// What a stored campaign has to report, before anything is rendered.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "reports/report.h"
#include "suite/app/load.h"
#include "suite/results/published.h"
#include "suite/results/report_model.h"

namespace physinv {

/// The papers' numbers. StoreError if one is missing that a claim names.
Published printed_numbers();

/// Claims, tables and figures of every experiment that was run, in the order in
/// which they are registered, each paper's overview first.
std::vector<Section> sections_of(const Results& results,
                                 const Published& published);

/// The papers in the order in which a report has them, then what no paper has.
std::vector<Group> groups_of(const Published& published);

/// Context of the campaign as far as a report states it, and where the
/// sections' experiments were published.
nlohmann::ordered_json provenance(const Loaded& loaded,
                                  const std::vector<Section>& sections,
                                  const Published& published);

}  // namespace physinv
