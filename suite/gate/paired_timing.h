/// Two programs against each other by the clock: pairs of runs, one right after
/// the other on the same core, in random order, until every case is decided or
/// the time is up.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "suite/gate/baseline.h"
#include "suite/gate/gate_report.h"
#include "suite/gate/sequential.h"

namespace physinv {

struct PairedTimingOptions {
  std::filesystem::path base, head;  ///< programs
  Chosen chosen;                     ///< profile and what replaces its keys
  std::vector<std::string> cases;
  std::filesystem::path out;  ///< where they run
  double seconds = 300;
  double alpha = 0.01;
  double margin = 0.02;    ///< what is equal
  std::uint64_t seed = 0;  ///< of the order
};

/// The program's cases, so that those which only one of the two has can be left
/// out. Throws EnvironmentError if it cannot list them.
std::set<std::string> cases_known_to(const std::filesystem::path& program,
                                     const Chosen& chosen);

/// Throws UsageError if the programs say that they are of other processors:
/// their times do not compare.
void require_one_processor(const std::filesystem::path& base,
                           const std::filesystem::path& head);

/// Runs a program on some cases: milliseconds of solving for each of them; no
/// number where a stage ended without a time.
using Runner = std::function<std::vector<double>(
    const std::filesystem::path& program, const std::vector<std::string>&)>;

/// Runs the program's verb `run`, here, on one core. Throws EnvironmentError
/// if it fails.
Runner timed_run(const PairedTimingOptions& options);

struct PairedTiming {
  std::vector<Decision> decisions;  ///< of each case
  /// Which programs have no time of a case, so that it is not run again.
  struct Untimed {
    bool base = false, head = false;
  };
  std::vector<Untimed> untimed;
  std::vector<std::size_t> pairs;
  double seconds = 0;
};

/// `tell`, if not empty, hears how many cases are left after each pair.
PairedTiming time_in_pairs(
    const PairedTimingOptions& options,
    const Runner& run,
    const std::function<void(std::size_t pair, std::size_t left)>& tell);

/// With `strict`, what stayed undecided ends the gate with exit code 8. A case
/// that has a time in the base alone ends worse.
std::vector<Finding> findings_of(const PairedTimingOptions& options,
                                 const PairedTiming& timing,
                                 bool strict);

}  // namespace physinv
