#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <malloc.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <new>
#include <string_view>
#include <system_error>

#include "suite/app/verbs.h"
#include "suite/harness/build_info.h"
#include "suite/harness/context.h"
#include "suite/harness/select.h"
#include "suite/results/errors.h"

namespace physinv {
namespace {

constexpr std::string_view kHelp =
    R"(Physics inverse problems: benchmarks of the papers, reproduced and timed.

physinv-bench [run] [flags]      run cases (the default verb)
physinv-bench list [flags]       the cases, their stages and estimated work
physinv-bench plan [flags]       time, memory and disk of a selection
physinv-bench report RESULTS     tables, plots and claims of a campaign
physinv-bench results           a page of all published campaigns
physinv-bench verify RESULTS     recompute every final loss
physinv-bench merge OUT SHARD..  join the results of shards
physinv-bench baseline RESULTS   what a campaign came to, as a text for reviews
physinv-bench gate [flags]       runs a baseline's cases: worse? slower?
physinv-bench compare A B..      campaigns side by side, what changed most
physinv-bench export RESULTS     for dashboards and other programs
physinv-bench completion SHELL   completion for bash, zsh or fish
physinv-bench submit [flags]     a campaign as an array of Slurm jobs
physinv-bench status DIR         how it stands
physinv-bench kernels [flags]    kernel benchmarks (flags of Google Benchmark)
physinv-bench VERB --help        flags of a verb
physinv-bench --version          version and build

examples
  physinv-bench --filter=billiards
  physinv-bench --profile=paper --filter=billiards --out=results/paper
  physinv-bench list --profile=smoke
  physinv-bench report results/quick

exit codes
)";

constexpr std::string_view kEnvironmentHelp = R"(
environment
  NO_COLOR   no colours
  COLUMNS    width of the live table
  CI, TERM=dumb, or no terminal: plain lines, one per stage
  PHYSINV_COUNT  the program whose instructions gate counts
  BENCHMARK_FILTER, BENCHMARK_OUT, BENCHMARK_OUT_FORMAT, BENCHMARK_FORMAT,
  BENCHMARK_REPETITIONS, BENCHMARK_LIST_TESTS: as the flags of run
  GTEST_TOTAL_SHARDS, GTEST_SHARD_INDEX (from 0): as --shard
  XDG_CACHE_HOME  where the speeds of this machine are kept (~/.cache)
  PHYSINV_PUBLISHED_DIR  the papers' numbers (reports/published)
)";

ExitCode dispatch(Arguments arguments) {
  if (arguments.empty() || arguments[0].starts_with('-')) {
    if (!arguments.empty() &&
        (arguments[0] == "--help" || arguments[0] == "-h")) {
      fmt::print("{}{}{}", kHelp, kExitCodeHelp, kEnvironmentHelp);
      return ExitCode::good;
    }
    if (!arguments.empty() && arguments[0] == "--version") {
      fmt::print("{}\n", version_text());
      return ExitCode::good;
    }
    if (!arguments.empty() && arguments[0] == "--list-verbs") {
      for (const auto& [name, call] : verbs()) fmt::print("{}\n", name);
      return ExitCode::good;
    }
    return run_verb(arguments);
  }
  const auto verb = verbs().find(arguments[0]);
  if (verb != verbs().end()) {
    arguments.erase(arguments.begin());
    return verb->second(arguments);
  }
  std::vector<std::string> known;
  for (const auto& [name, call] : verbs()) known.push_back(name);
  const std::string near = nearest_word(known, arguments[0]);
  throw UsageError(fmt::format(
      "unknown verb '{}'; {}",
      arguments[0],
      near.empty() ? fmt::format("known are {}", fmt::join(known, ", "))
                   : "did you mean " + near + "?"));
}

/// Whoever starts us may have closed 0, 1 or 2. The next file that opens would
/// take the place, and what is printed would land in the journal or the lock.
void open_standard_streams() {
  int fd = 0;
  while (fd >= 0 && fd <= STDERR_FILENO) fd = open("/dev/null", O_RDWR);
  if (fd >= 0) close(fd);
}

/// The build may come from another machine.
bool can_run_here() {
#ifdef PHYSINV_AVX512
  return __builtin_cpu_supports("avx512vl") != 0;
#else
  return __builtin_cpu_supports("avx2") != 0;
#endif
}

constexpr const char* kUnwritable =
    "standard output cannot be written; a disk may be full";

/// One line, whatever the exception says.
ExitCode complain(ExitCode code, std::string text) {
  for (char& c : text)
    if (c == '\n') c = ' ';
  std::fflush(stdout);
  // fmt::print would throw where standard error cannot be written either.
  std::fputs(fmt::format("physinv-bench: {}\n", text).c_str(), stderr);
  return code;
}

ExitCode guarded(Arguments arguments) {
  if (!can_run_here())
    return complain(ExitCode::environment,
                    fmt::format("built for {}, which this processor is not; "
                                "remove the build directory to build anew",
                                build_info().instruction_set));
  try {
    const ExitCode code = dispatch(std::move(arguments));
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      return complain(ExitCode::environment, kUnwritable);
    return code;
  } catch (const ExitError& error) {
    return complain(error.code(), error.what());
  } catch (const UnreadableInput& error) {
    return complain(ExitCode::usage, error.what());
  } catch (const StoreError& error) {
    return complain(ExitCode::environment, error.what());
  } catch (const std::bad_alloc&) {
    return complain(ExitCode::environment,
                    "out of memory; fewer --jobs may do");
  } catch (const std::system_error& error) {  // fmt::print throws it, too
    return complain(ExitCode::environment,
                    std::ferror(stdout) != 0 ? kUnwritable : error.what());
  } catch (const std::exception& error) {
    return complain(ExitCode::internal,
                    fmt::format("internal error: {}", error.what()));
  }
}

}  // namespace
}  // namespace physinv

int main(int argc, char** argv) {
  physinv::open_standard_streams();
  // Records of some 100 kB come and go; the default hands each back to the
  // system and pays for its pages again.
  mallopt(M_MMAP_THRESHOLD, 64 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  return static_cast<int>(
      physinv::guarded(physinv::Arguments(argv + 1, argv + argc)));
}
