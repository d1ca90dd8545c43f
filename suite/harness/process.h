/// Other programs.
#pragma once

#include <string>
#include <vector>

namespace physinv {

struct ProgramOutput {
  int status = -1;   ///< of its exit; -1: it did not start, or was killed
  std::string text;  ///< its output without line ends at the end
};

/// Runs a program found in PATH to its end. `errors`: its standard error is
/// part of the output, else dropped.
ProgramOutput run_program(std::vector<std::string> arguments,
                          bool errors = false);

/// Does PATH have it?
bool has_program(const std::string& name);

}  // namespace physinv
