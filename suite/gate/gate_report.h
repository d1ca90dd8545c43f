/// What a gate found, for the terminal, a pull request's summary, annotations
/// and machines.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "suite/gate/verdict.h"
#include "suite/harness/errors.h"

namespace physinv {

/// One thing judged.
struct Finding {
  std::string kind;  ///< accuracy, instructions, clock
  std::string name;  ///< of a stage or a case
  std::string verdict, detail;
  ExitCode code = ExitCode::good;  ///< that it alone would end the gate with
  nlohmann::json numbers;          ///< for machines
  Reasons reasons = {};            ///< of a stage
  std::optional<Distance> distance = {};
};

Finding finding_of(const StageVerdict& judgement);

struct GateReport {
  std::vector<std::string> notes;
  std::vector<Finding> findings;

  /// The gravest: accuracy before slower before inconclusive.
  ExitCode code() const;
};

/// One line: counts by kind and verdict.
std::string summary_text(const GateReport& report);
/// Where the clock was asked and decided nothing; else empty.
std::string undecided_text(const GateReport& report);
/// "largest relative change 2e-16 in x of jpo/.../solve, 3e-15 in the best loss
/// of ..."; empty if no stage changed by the numbers of its line.
std::string largest_text(const GateReport& report);
/// Notes, everything that is not as it was, and the summary.
std::string terminal_text(const GateReport& report);
std::string markdown_text(const GateReport& report);
/// One `::error` of GitHub's workflow commands for each finding that fails, up
/// to ten, and a `::warning` where the clock decided nothing.
std::string annotations(const GateReport& report);
nlohmann::json to_json(const GateReport& report);

}  // namespace physinv
