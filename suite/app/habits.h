/// What users of Google Benchmark and GoogleTest are used to: their flags on
/// `run`, and their environment where a flag is not given.
#pragma once

#include <string>
#include <vector>

#include "suite/app/options.h"

namespace physinv {

struct Habits {
  std::string filter, out, out_format = "json", format = "console";
  int repetitions = 1;
  bool list = false;

  std::vector<Flag> flags();
  /// BENCHMARK_FILTER and so on become the defaults. Before the command line.
  void read_environment();
  /// Into the selection: the filter, and GTEST_TOTAL_SHARDS and
  /// GTEST_SHARD_INDEX if no shard is asked for. UsageError for what cannot be.
  void apply(Selection& selection) const;
};

}  // namespace physinv
