#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <malloc.h>
#include <sys/auxv.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <string_view>
#include <system_error>

#include "suite/app/flags.h"
#include "suite/app/plugins.h"
#include "suite/app/verbs.h"
#include "suite/harness/build_info.h"
#include "suite/harness/context.h"
#include "suite/harness/output.h"
#include "suite/harness/registry.h"
#include "suite/results/nearest.h"
#include "suite/store/errors.h"

namespace physinv {
namespace {

constexpr std::string_view kTitle =
    "Physics inverse problems: reproduces and times benchmarks of papers.\n\n";

constexpr std::string_view kEnvironmentHelp = R"(
environment; an empty variable counts as not set
  NO_COLOR   no colours
  COLUMNS    width of the live table
  CI, TERM=dumb, or no terminal: plain lines, one per stage
  BENCHMARK_FILTER, BENCHMARK_OUT, BENCHMARK_OUT_FORMAT, BENCHMARK_FORMAT,
  BENCHMARK_REPETITIONS, BENCHMARK_LIST_TESTS: the same as the flags of run,
             which take precedence
  PHYSINV_PLUGINS  plug-ins to load, as --plugin, separated by colons
  GTEST_TOTAL_SHARDS, GTEST_SHARD_INDEX (from 0): the same as --shard
  XDG_CACHE_HOME  directory of the measured speed of this machine (~/.cache)
)";

std::string help_line(std::string_view usage, std::string_view about) {
  return fmt::format(
      "{:<32} {}\n", fmt::format("{} {}", program().name, usage), about);
}

std::string help_text() {
  std::string text(kTitle);
  for (const Verb& verb : program().verbs)
    text += help_line(
        fmt::format("{} {}",
                    verb.name == "run" ? "[run]" : std::string(verb.name),
                    verb.takes),
        verb.about);
  text +=
      help_line("VERB --help", "print the flags of a verb; also: help VERB");
  text += help_line("--plugin=FILE ..", "load a plug-in, before or after VERB");
  text += help_line("--version, -V", "print version and build");
  text += "\nexamples\n";
  for (const auto& example : program().examples)
    text += fmt::format("  {} {}\n", program().name, example);
  text += fmt::format("\nexit codes\n{}", kExitCodeHelp);
  return text + std::string(kEnvironmentHelp) +
         std::string(program().environment);
}

/// Of the program itself. False if it is none of those.
bool answered(const std::string& flag) {
  if (flag == "--help" || flag == "-h" || flag == "help") {
    fmt::print("{}", help_text());
  } else if (flag == "--version" || flag == "-V") {
    fmt::print("{}\n", version_text());
  } else if (flag == "--list-verbs") {
    for (const Verb& verb : program().verbs) fmt::print("{}\n", verb.name);
  } else {
    return false;
  }
  return true;
}

[[noreturn]] void refuse_verb(const std::string& word) {
  std::vector<std::string> known;
  for (const Verb& verb : program().verbs) known.emplace_back(verb.name);
  const std::string near = nearest_word(known, word);
  throw UsageError(fmt::format(
      "unknown verb '{}'; {}",
      word,
      near.empty()
          ? fmt::format("known verbs: {}; 'run {}' runs the cases of that name",
                        fmt::join(known, ", "),
                        word)
          : "did you mean " + near + "?"));
}

ExitCode dispatch(Arguments arguments) {
  refuse_empty(arguments);
  // Without registering, which takes longer than everything else.
  if (arguments.size() == 1 && answered(arguments[0])) return ExitCode::good;
  register_all(registry());
  load_plugins(arguments);
  if (arguments.empty()) return run_verb(arguments);
  if (arguments[0] == "help" && arguments.size() > 1) {
    if (arguments.size() > 2)
      throw UsageError("help takes one verb, as in 'help run'");
    arguments = {arguments[1], "--help"};
  }
  if (answered(arguments[0])) return ExitCode::good;
  if (arguments[0].starts_with('-')) return run_verb(arguments);
  for (const Verb& verb : program().verbs) {
    if (verb.name != arguments[0]) continue;
    arguments.erase(arguments.begin());
    return verb.call(arguments);
  }
  refuse_verb(arguments[0]);
}

/// The calling process may have closed 0, 1 or 2. The next file that opens
/// would take the place, and what is printed would land in the journal or the
/// lock. Output that was closed cannot be written into: what is printed there
/// fails.
void open_standard_streams() {
  int fd = 0;
  while (fd >= 0 && fd <= STDERR_FILENO) {
    const bool output_is_open = fcntl(STDOUT_FILENO, F_GETFD) != -1;
    fd = open("/dev/null", output_is_open ? O_RDWR : O_RDONLY);
  }
  if (fd >= 0) close(fd);
}

/// The build may come from another machine.
bool can_run_here() {
#if defined(PHYSINV_AVX512)
  return __builtin_cpu_supports("avx512vl") != 0;
#elif defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#elif defined(__ARM_FEATURE_CRC32)
  return (getauxval(AT_HWCAP) & HWCAP_CRC32) != 0;
#else
  return true;
#endif
}

constexpr const char* kUnwritable =
    "cannot write standard output; it may be closed, the disk full, or the "
    "limit on file sizes (ulimit -f) too low";

ExitCode complain(ExitCode code, std::string_view text) {
  put(stdout, "");  // what was said before
  put(stderr, fmt::format("{}: {}\n", program().name, one_line(text)));
  return code;
}

ExitCode guarded(Arguments arguments) {
  if (!can_run_here())
    return complain(
        ExitCode::environment,
        fmt::format("built for {}, which this processor does not support; "
                    "remove the build directory and build again",
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
    return complain(ExitCode::environment, "out of memory; try fewer --jobs");
  } catch (const std::system_error& error) {  // fmt::print throws it, too
    return complain(ExitCode::environment,
                    std::ferror(stdout) != 0 ? kUnwritable : error.what());
  } catch (const std::exception& error) {
    return complain(ExitCode::internal,
                    fmt::format("internal error: {}", error.what()));
  }
}

/// Records of some 100 kB come and go; the default hands each back to the
/// system and pays for its pages again. What is registered takes thousands of
/// pages, whose first touches cost more than to fill them: the heap begins with
/// huge ones, before the first constant of a source is made. A system without
/// them ignores the advice.
[[gnu::constructor(101)]] void set_up_heap() {
  mallopt(M_MMAP_THRESHOLD, 64 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  constexpr std::size_t kHugePage = 2 << 20, kFirst = 16 * kHugePage;
  void* begin = std::malloc(kFirst);
  void* p = begin;
  std::size_t room = kFirst;
  if (std::align(kHugePage, kFirst - kHugePage, p, room) != nullptr)
    madvise(p, kFirst - kHugePage, MADV_HUGEPAGE);
  std::free(begin);
}

}  // namespace
}  // namespace physinv

int main(int argc, char** argv) {
  physinv::open_standard_streams();
  // A write beyond the limit on file sizes then fails with EFBIG and is
  // reported.
  std::signal(SIGXFSZ, SIG_IGN);
  return static_cast<int>(physinv::guarded(
      physinv::Arguments(argv + std::min(1, argc), argv + argc)));
}
