// A command line: words of the environment first, NAME=value, then one argument
// a line. It is read and chooses cases, and nothing is done with them.
#include <algorithm>
#include <array>
#include <cstdlib>

#include "suite/app/benchmark_flags.h"
#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {
namespace {

constexpr std::array kVariables = {"BENCHMARK_FILTER",
                                   "BENCHMARK_OUT",
                                   "BENCHMARK_OUT_FORMAT",
                                   "BENCHMARK_FORMAT",
                                   "BENCHMARK_REPETITIONS",
                                   "BENCHMARK_LIST_TESTS",
                                   "GTEST_TOTAL_SHARDS",
                                   "GTEST_SHARD_INDEX"};

/// Sets the variable if the line is one of them.
bool set_variable(const std::string& line) {
  const auto [name, value] = halves(line, "=");
  const auto at = std::find(kVariables.begin(), kVariables.end(), name);
  if (at == kVariables.end()) return false;
  setenv(*at, std::string(value).c_str(), 1);
  return true;
}

/// The arguments; the environment is as the lines before them say.
Arguments prepared(std::string_view bytes) {
  for (const char* name : kVariables) unsetenv(name);
  Arguments arguments;
  while (!bytes.empty()) {
    const auto [line, rest] = halves(bytes, "\n");
    // Neither may hold a zero.
    const std::string word(line.substr(0, line.find('\0')));
    if (!arguments.empty() || !set_variable(word)) arguments.push_back(word);
    bytes = rest;
  }
  return arguments;
}

/// The flags of `run`, and an argument as other verbs have it.
void read(const Arguments& arguments) {
  refuse_empty(arguments);
  Selection selection;
  BenchmarkFlags benchmark;
  std::string budget;
  int jobs = 1;
  double within = 1;
  bool resume = true;
  std::vector<std::string> shards;
  std::vector<Flag> own = benchmark.flags();
  own.push_back({"--jobs", "", &jobs});
  own.push_back({"--within", "", &within});
  own.push_back({"--time-budget", "", &budget, "TIME"});
  own.push_back({"--resume,!--fresh", "", &resume});
  if (!arguments.empty() && arguments[0] == "merge")
    own.push_back({"SHARDS", "", &shards});
  if (!parse("run", "", selection.flags(own), arguments)) return;
  benchmark.complete(selection);
  if (!budget.empty()) parse_duration("--time-budget", budget);
  selection.cases();
}

}  // namespace

void command_line(std::string_view bytes) {
  const Arguments arguments = prepared(bytes);
  documented([&] { read(arguments); });
}

}  // namespace physinv::fuzz
