/// What stages of published campaigns took: the table that
/// reports/durations.py writes.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "suite/core/batch.h"

namespace physinv {

/// Seconds of one thread, set-up and measuring included: the median, and what
/// it may be from fast runs to slow ones.
struct TimeRange {
  double seconds = 0, least = 0, most = 0;
};

class Durations {
 public:
  /// None of a file that is not there; StoreError for a line that is none.
  static Durations read(const std::filesystem::path& file);

  /// By the row of this experiment, method and stage whose counted operations
  /// are nearest, in proportion to them. Nothing if there is none, or if they
  /// differ by more than a factor of four.
  std::optional<TimeRange> time(const std::string& experiment,
                                const std::string& method,
                                const std::string& stage,
                                double operations) const;
  /// The bytes of buffers that this stage counted on n samples.
  std::optional<double> bytes(const std::string& experiment,
                              const std::string& method,
                              const std::string& stage,
                              Index n) const;

 private:
  using Kind = std::tuple<std::string, std::string, std::string>;
  struct Row {
    Index n;
    double operations;
    TimeRange time;
    double bytes;
  };
  std::map<Kind, std::vector<Row>> rows_;
};

/// Seconds of a product of matrices on this machine over those on the machine
/// that the table's times are scaled to: the least of many, of the processor,
/// rounded to a power of sqrt(2), so that repeated calls agree.
double machine_factor();

}  // namespace physinv
