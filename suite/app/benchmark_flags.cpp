#include "suite/app/benchmark_flags.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>

#include "suite/core/decimal.h"
#include "suite/harness/context.h"
#include "suite/harness/select.h"
#include "suite/results/nearest.h"

namespace physinv {
namespace {

int whole(const char* name, const std::string& text, int least) {
  const auto value = decimal<int>(text);
  if (!value || *value < least || *value > 1'000'000)
    throw UsageError(fmt::format(
        "{}={} is not a whole number of at least {}", name, text, least));
  return *value;
}

void check(const char* flag,
           const std::string& value,
           const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), value) != known.end()) return;
  const std::string near = nearest_word(known, value);
  throw UsageError(
      near.empty()
          ? fmt::format("{}={} is unknown; known values: {}",
                        flag,
                        value,
                        fmt::join(known, ", "))
          : fmt::format(
                "{}={} is unknown; did you mean {}?", flag, value, near));
}

/// An existing file is kept, and a pipe without a reader is not waited for.
void touch(const std::string& file) {
  const int fd =
      open(file.c_str(), O_WRONLY | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0644);
  if (fd >= 0) close(fd);
}

/// GoogleTest's protocol: a program that reads the variables creates this file.
std::string shard_of_environment() {
  const std::string total = variable("GTEST_TOTAL_SHARDS"),
                    index = variable("GTEST_SHARD_INDEX");
  if (total.empty() && index.empty()) return "";
  if (total.empty() || index.empty())
    throw UsageError(
        "set both GTEST_TOTAL_SHARDS and GTEST_SHARD_INDEX; one is not set");
  const int parts = whole("GTEST_TOTAL_SHARDS", total, 1);
  const int part = whole("GTEST_SHARD_INDEX", index, 0);
  if (part >= parts)
    throw UsageError(fmt::format(
        "GTEST_SHARD_INDEX={} is out of range for {} shards; expected 0 to {}",
        part,
        parts,
        parts - 1));
  if (const std::string file = variable("GTEST_SHARD_STATUS_FILE");
      !file.empty())
    touch(file);
  return fmt::format("{}/{}", part + 1, parts);
}

/// What a flag left empty is what the variable says, else `usual`.
void take(std::string& to, const char* name, const char* usual) {
  if (to.empty()) to = variable(name);
  if (to.empty()) to = usual;
}

/// The variable gives way to --filter, too, which --benchmark_filter is the
/// same as.
void take_filter(const std::string& flag, Selection& selection) {
  const bool from_variable = flag.empty() && selection.filters.empty();
  const std::string filter =
      from_variable ? variable("BENCHMARK_FILTER") : flag;
  if (filter.empty() || filter == "all") return;
  NameFilter({filter},
             from_variable ? "BENCHMARK_FILTER" : "--benchmark_filter");
  selection.filters.push_back(filter);
}

}  // namespace

std::vector<Flag> BenchmarkFlags::flags() {
  return {
      {"--benchmark_filter", "the same as --filter", &filter, "REGEX"},
      {"--benchmark_list_tests",
       "print the names of the cases and exit",
       &list},
      {"--benchmark_repetitions",
       "measure the times of all stages N times, including reused ones; "
       "results do not change",
       &repetitions,
       "N"},
      {"--benchmark_format",
       "format of standard output: console (default), json or csv",
       &format,
       "FORMAT"},
      {"--benchmark_out",
       "also write the results to this file, with repetitions and their spread",
       &out,
       "FILE"},
      {"--benchmark_out_format",
       "json (default) or csv",
       &out_format,
       "FORMAT"}};
}

BenchmarkFlags::BenchmarkFlags() {
  const auto all = variable("BENCHMARK_LIST_TESTS");
  list = !all.empty() && all != "0" && all != "false";
}

void BenchmarkFlags::complete(Selection& selection) {
  take_filter(filter, selection);
  take(out, "BENCHMARK_OUT", "");
  take(out_format, "BENCHMARK_OUT_FORMAT", "json");
  take(format, "BENCHMARK_FORMAT", "console");
  if (repetitions == 0) {
    std::string times;
    take(times, "BENCHMARK_REPETITIONS", "1");
    repetitions = whole("BENCHMARK_REPETITIONS", times, 1);
  }
  check("--benchmark_format", format, {"console", "json", "csv"});
  check("--benchmark_out_format", out_format, {"json", "csv"});
  if (selection.shard.empty()) selection.shard = shard_of_environment();
}

}  // namespace physinv
