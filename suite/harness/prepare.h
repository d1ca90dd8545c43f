/// Cases made ready to run.
#pragma once

#include <string>
#include <vector>

#include "suite/harness/case.h"

namespace physinv {

/// Cases with their data drawn, one ulp off with `disturb`, and content keys
/// filled in.
struct Prepared {
  std::vector<Case> cases;
  std::vector<CaseData> data;
  std::vector<std::string> errors;  ///< why data could not be drawn, or empty
  double data_cpu = 0;              ///< CPU seconds of drawing them
};
Prepared prepare(std::vector<Case> cases, bool disturb = false);

}  // namespace physinv
