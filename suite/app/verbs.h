/// The verbs of the command line, one file each. They return an exit code and
/// throw ExitError for what ends them early.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "suite/harness/errors.h"

namespace physinv {

/// What follows the verb.
using Arguments = std::vector<std::string>;

/// What a program has of them, by name.
using Verb = ExitCode (*)(const Arguments&);
const std::map<std::string, Verb>& verbs();

ExitCode run_verb(const Arguments& arguments);
ExitCode list_verb(const Arguments& arguments);
ExitCode report_verb(const Arguments& arguments);
ExitCode results_verb(const Arguments& arguments);
ExitCode verify_verb(const Arguments& arguments);
ExitCode merge_verb(const Arguments& arguments);
ExitCode compare_verb(const Arguments& arguments);
ExitCode export_verb(const Arguments& arguments);
ExitCode completion_verb(const Arguments& arguments);
ExitCode submit_verb(const Arguments& arguments);
ExitCode status_verb(const Arguments& arguments);
ExitCode plan_verb(const Arguments& arguments);
ExitCode kernels_verb(const Arguments& arguments);
ExitCode baseline_verb(const Arguments& arguments);
ExitCode gate_verb(const Arguments& arguments);

}  // namespace physinv
