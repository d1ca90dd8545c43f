/// What ends the program, by exit code. Messages read "what is wrong; what
/// would be right" and are one line.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace physinv {

enum class ExitCode : int {
  good = 0,
  internal = 1,
  usage = 2,
  nothing_matched = 3,
  case_failed = 4,
  accuracy = 5,
  slower = 6,
  claim = 7,
  inconclusive = 8,
  environment = 9,
  incomplete = 10,
  interrupted = 130,
};

/// The same in the words of --help. Where several apply, 130 comes before 4
/// before 5 and so on to 10.
inline constexpr std::string_view kExitCodeHelp =
    R"(    0  good, and complete
    1  internal error
    2  wrong usage, or input that cannot be read
    3  nothing matched; the nearest names are printed
    4  a case failed (exception, out of memory), verify found a mismatch, or
       conformance a broken contract; divergence is a result
    5  gate: a stage is worse than in the baseline, or missing; compare
       --fail-on: losses, statuses, claims or work got worse, or runs are
       missing
    6  slower: gate, by instructions or measured time; compare --fail-on, if
       nothing else got worse
    7  a gating claim is not reproduced and states no cause (report --check);
       a verdict changed (reproduce)
    8  gate --strict: the timing comparison was not decided within its budget
    9  environment: disk full, unwritable, corrupt store
   10  incomplete: cases not run (--time-budget, shards missing), stages that
       failed or lost their arrays, no plan.json, or nothing to judge (report
       --check); everything else was run, reported, verified or merged
  130  interrupted; finished stages are kept
)";

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
