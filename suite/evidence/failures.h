/// Runs that failed. A statistic over the others would be of those that the
/// method happens to bring to an end: it has no value, and says why.
#pragma once

#include <string>
#include <vector>

#include "suite/evidence/runs.h"
#include "suite/results/report_model.h"

namespace physinv {

/// "1 of 3 runs failed": of the cases selected those whose stage (or, without
/// one, whose chain) failed or was skipped behind one that did. Empty if none
/// did. Cases that were not run are not counted.
std::string failed_text(const Evidence& evidence, const Select& select);

/// Why no run selected has a value: "adam not run", "adam crowded", "adam too
/// short, or without this value".
std::string why_no_value(const Evidence& evidence, const Select& select);

/// What a cell says where that is why a number is missing, else empty.
std::string failed_part(const std::string& missing);

/// A row for each run of the experiment that failed, with the stage and its
/// message. No rows if none did.
Table failed_runs(const Results& results, const std::string& experiment);

}  // namespace physinv
