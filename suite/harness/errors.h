/// What ends the program, by exit code. Messages read "what is wrong; what
/// would be right" and are one line.
#pragma once

#include <stdexcept>

namespace physinv {

enum class ExitCode : int {
  good = 0,
  internal = 1,
  usage = 2,
  nothing_matched = 3,
  case_failed = 4,
  // 5 accuracy regression, 6 timing regression, 8 inconclusive: a later gate
  claim = 7,
  environment = 9,
  interrupted = 130,
};

class ExitError : public std::runtime_error {
 public:
  ExitError(ExitCode code, const std::string& message)
      : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// Usage, or input that cannot be read.
struct UsageError : ExitError {
  explicit UsageError(const std::string& message)
      : ExitError(ExitCode::usage, message) {}
};

/// Disk full, unwritable, corrupt store.
struct EnvironmentError : ExitError {
  explicit EnvironmentError(const std::string& message)
      : ExitError(ExitCode::environment, message) {}
};

}  // namespace physinv
