/// What users of Google Benchmark and GoogleTest are used to: their flags on
/// `run`, and their environment where a flag is not given.
#pragma once

#include <string>
#include <vector>

#include "suite/app/options.h"

namespace physinv {

struct BenchmarkFlags {
  std::string filter, out, out_format, format;
  int repetitions = 0;
  bool list = false;  ///< from the start as BENCHMARK_LIST_TESTS says

  BenchmarkFlags();
  std::vector<Flag> flags();
  /// After the command line: what it leaves open is as BENCHMARK_FILTER and so
  /// on say, or as always. Then into the selection: the filter, and
  /// GTEST_TOTAL_SHARDS and GTEST_SHARD_INDEX if no shard is asked for.
  /// UsageError for what cannot be.
  void complete(Selection& selection);
};

}  // namespace physinv
