/// How problems ended, and how many of them where they started.
#pragma once

#include <map>
#include <string>

#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv {

/// A row for each method and stage that solves problems one by one
/// (optimizers/minimize.h): how many problems of all n and seeds ended with
/// each status, and how many stayed at their start. Columns of zeros are left
/// out. No rows if every problem has moved and ended as `gtol`.
Table status_table(const Results& results,
                   const std::string& experiment,
                   const std::map<std::string, std::string>& method_titles);

}  // namespace physinv
