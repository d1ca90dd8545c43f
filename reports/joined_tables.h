/// Tables that a paper prints over several of its experiments.
#pragma once

#include <string>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

/// Of the sections of this paper's experiments: the tables that two of them or
/// more have under one place ("Table 4"), title and columns, as one, with the
/// rows of all in the order of the sections. Rows that are not called like
/// their experiment have its title in front.
std::vector<Table> joined_tables(const std::vector<Section>& sections,
                                 const std::string& paper);

}  // namespace physinv
