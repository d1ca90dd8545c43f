/// Runs the cases that a baseline holds, as drawn and with data one ulp off.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "suite/gate/stage_line.h"
#include "suite/harness/screen.h"

namespace physinv {

struct Case;
struct CaseRecord;

struct MeasureOptions {
  std::filesystem::path out;
  int jobs = 1;
  bool resume = false;
};

std::set<std::string> names_of(const std::vector<Case>& cases);

/// Stages of these cases, run with a trace into `out`. Throws ExitError if it
/// was interrupted.
std::vector<StageLine> measure(const std::vector<Case>& cases,
                               const MeasureOptions& options,
                               const Screen& screen);

/// Runs the cases again with data one ulp off, into the folder `disturbed` of
/// `out`, and enters digits, jitter and times.
void measure_digits(std::vector<StageLine>& lines,
                    const std::vector<Case>& cases,
                    MeasureOptions options,
                    const Screen& screen);

/// The lines of a finished campaign; UsageError if it was run without --trace
/// or lacks something.
std::vector<StageLine> lines_of(const std::vector<CaseRecord>& cases);

}  // namespace physinv
