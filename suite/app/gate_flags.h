/// Flags of `gate`, and what it shares with `baseline`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "suite/app/flags.h"
#include "suite/gate/baseline.h"
#include "suite/gate/measure.h"
#include "suite/harness/case.h"

namespace physinv {

struct GateFlags {
  std::string baseline, profile, results, against, head, json;
  std::string out = "results/gate";
  std::vector<std::string> filters;
  int jobs = 0, seed = 1;
  double budget = 300, within = 2;
  bool allow_work = false, count = true, strict = false, update = false;

  std::vector<Flag> flags();
  MeasureOptions measuring() const;
};

/// The registered cases of a baseline that match `filters`, too. An error in
/// its own filters says `whose` they are.
std::vector<Case> cases_of(const Chosen& chosen,
                           const std::vector<std::string>& filters = {},
                           const std::string& whose = "the campaign's filter");

/// 0: as many as there are cores.
int jobs_or_cores(int jobs);

/// physinv-count: what PHYSINV_COUNT names, else the one in the folder of this
/// program.
std::filesystem::path counting_program();

}  // namespace physinv
