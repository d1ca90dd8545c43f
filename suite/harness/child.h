/// Other programs, run to their end.
#pragma once

#include <string>
#include <vector>

namespace physinv {

struct Ended {
  int status = -1;  ///< exit code; 128 + signal; -1: it could not be started
  std::string output, errors;
};

/// Does PATH have it?
bool has_program(const std::string& name);

/// Finds the program in PATH unless it has a slash. Nothing stands in its
/// standard input.
Ended run_child(std::vector<std::string> arguments);

}  // namespace physinv
