/// What `baseline` and `gate` share.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "suite/gate/baseline.h"
#include "suite/harness/case.h"

namespace physinv {

/// The registered cases of a baseline that match `filters`, too.
std::vector<Case> cases_of(const Chosen& chosen,
                           const std::vector<std::string>& filters = {});

/// 0: as many as there are cores.
int jobs_or_cores(int jobs);

/// physinv-count: what PHYSINV_COUNT names, else the one beside this program.
std::filesystem::path counting_program();

}  // namespace physinv
