/// The verbs of the command line, one file each. They return an exit code and
/// throw ExitError for what ends them early.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "suite/harness/errors.h"

namespace physinv {

/// What follows the verb.
using Arguments = std::vector<std::string>;

struct Verb {
  std::string_view name, takes, about;
  ExitCode (*call)(const Arguments&);
};

struct RunEnd;

/// What a program's help says in addition to what all programs have.
struct Program {
  std::string_view name;
  std::vector<Verb> verbs;
  std::vector<std::string_view> examples;
  std::string_view environment;  ///< variables of its verbs
  /// What a run ends with (conclude.h); null: with its results alone.
  void (*conclude)(const RunEnd&) = nullptr;
};

/// The one that was started.
const Program& program();

ExitCode run_verb(const Arguments& arguments);
ExitCode list_verb(const Arguments& arguments);
ExitCode report_verb(const Arguments& arguments);
ExitCode results_verb(const Arguments& arguments);
ExitCode reproduce_verb(const Arguments& arguments);
ExitCode history_verb(const Arguments& arguments);
ExitCode verify_verb(const Arguments& arguments);
ExitCode merge_verb(const Arguments& arguments);
ExitCode compare_verb(const Arguments& arguments);
ExitCode export_verb(const Arguments& arguments);
ExitCode completion_verb(const Arguments& arguments);
ExitCode submit_verb(const Arguments& arguments);
ExitCode status_verb(const Arguments& arguments);
ExitCode plan_verb(const Arguments& arguments);
ExitCode conformance_verb(const Arguments& arguments);
ExitCode kernels_verb(const Arguments& arguments);
ExitCode baseline_verb(const Arguments& arguments);
ExitCode gate_verb(const Arguments& arguments);

/// The verb that every program has.
inline constexpr Verb kRunVerb{
    "run", "[FILTER]", "run cases (the default verb)", run_verb};

}  // namespace physinv
