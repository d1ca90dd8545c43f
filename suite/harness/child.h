/// Other programs, run to their end.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace physinv {

/// What a program may take. One that exceeds it is killed.
struct ChildLimits {
  double seconds = std::numeric_limits<double>::infinity();
  std::size_t bytes = 64 << 20;  ///< of output, and of errors
};

struct Ended {
  int status = -1;  ///< exit code; 128 + signal; -1: it could not be started
  std::string output, errors;
  std::string exceeded;  ///< which limit, in words; empty: none
};

/// Does PATH have it?
bool has_program(const std::string& name);

/// Finds the program in PATH unless it has a slash. Its standard input is
/// empty.
Ended run_child(std::vector<std::string> arguments,
                const ChildLimits& limits = {});

}  // namespace physinv
