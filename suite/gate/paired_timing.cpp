#include "suite/gate/paired_timing.h"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "suite/core/clock.h"
#include "suite/core/math.h"
#include "suite/core/rng.h"
#include "suite/harness/child.h"
#include "suite/harness/processor.h"
#include "suite/harness/select.h"
#include "suite/store/results_file.h"
#include "suite/store/results_json.h"
#include "suite/store/store.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

/// While it lives, this process and those that it starts have one core, the
/// `which`-th of those that it may have.
class OneCore {
 public:
  explicit OneCore(std::uint64_t which) {
    if (sched_getaffinity(0, sizeof(before_), &before_) != 0) return;
    which %= static_cast<std::uint64_t>(std::max(1, CPU_COUNT(&before_)));
    for (int core = 0; core < CPU_SETSIZE; ++core) {
      if (!CPU_ISSET(core, &before_) || which-- != 0) continue;
      cpu_set_t one;
      CPU_ZERO(&one);
      CPU_SET(core, &one);
      set_ = sched_setaffinity(0, sizeof(one), &one) == 0;
      return;
    }
  }
  ~OneCore() {
    if (set_) sched_setaffinity(0, sizeof(before_), &before_);
  }
  OneCore(const OneCore&) = delete;
  OneCore& operator=(const OneCore&) = delete;

 private:
  cpu_set_t before_{};
  bool set_ = false;
};

/// CPU time of solving: on one thread the same as by the wall, without what
/// others took from the core. No number where a stage failed or diverged, which
/// costs less and is not a gain.
std::map<std::string, double> times(const fs::path& directory) {
  std::map<std::string, double> sums;
  const auto results = read_results(directory);
  for (const auto& stage : results.at("benchmarks")) {
    const auto time = stage.find("cpu_time");
    const auto stop = stage.at("physinv").find("stop");
    const bool ends_well = stop != stage.at("physinv").end() &&
                           (*stop == to_string(Stop::converged) ||
                            *stop == to_string(Stop::iterations));
    sums[case_of(stage.at("name").get<std::string>())] +=
        ends_well && time != stage.end() && time->is_number()
            ? seconds_per_unit(stage) * time->get<double>()
            : std::numeric_limits<double>::quiet_NaN();
  }
  return sums;
}

std::vector<std::string> command(const fs::path& program,
                                 std::string verb,
                                 const Chosen& chosen,
                                 std::vector<std::string> flags) {
  std::vector<std::string> all = {
      program.string(), std::move(verb), "--profile=" + chosen.profile};
  for (const auto& set : chosen.sets) all.push_back("--set=" + set);
  if (!chosen.seeds.empty()) all.push_back("--seeds=" + chosen.seeds);
  all.insert(all.end(), flags.begin(), flags.end());
  return all;
}

/// A sentence about a program that does not do what is asked of it.
std::string ending_of(const std::string& program, const Ended& ended) {
  if (!ended.exceeded.empty())
    return fmt::format("{} was killed: {}", program, ended.exceeded);
  if (ended.status < 0) return program + " cannot start";
  return fmt::format("{} exited with {}: {}",
                     program,
                     ended.status,
                     ended.errors.substr(0, ended.errors.find('\n')));
}

std::string output_of(const std::vector<std::string>& arguments) {
  const Ended ended = run_child(arguments);
  if (ended.status == static_cast<int>(ExitCode::interrupted))
    throw ExitError(ExitCode::interrupted, "interrupted; nothing was decided");
  if (ended.status != 0) throw EnvironmentError(ending_of(arguments[0], ended));
  return ended.output;
}

[[noreturn]] void refuse_program(const std::string& why) {
  throw EnvironmentError(
      why + "; expected a physinv-bench or a directory that contains one");
}

constexpr double kLongestAnswer = 20;

/// As the program's --version says; empty if it does not.
std::string processor_of(const fs::path& program) {
  const Ended ended =
      run_child({program.string(), "--version"}, {.seconds = kLongestAnswer});
  constexpr std::string_view kLine = "\ninstruction set ";
  const auto at = ended.output.find(kLine);
  if (ended.status != 0 || at == std::string::npos) return "";
  std::string_view set =
      std::string_view(ended.output).substr(at + kLine.size());
  set.remove_prefix(std::min(set.find_first_not_of(' '), set.size()));
  return std::string(processor_kind(set.substr(0, set.find('\n'))));
}

std::string percent(double log_ratio) {
  return std::isfinite(log_ratio)
             ? fmt::format("{:+.2f} %", 100 * math::expm1(log_ratio))
             : std::string(log_ratio < 0 ? "-inf" : "+inf");
}

std::string detail_of(const Decision& d, std::size_t pairs, double margin) {
  if (pairs == 0) return "no pair of runs within the budget";
  return fmt::format(
      "{}, with {:g} % confidence {} to {}, {} pairs; equal is within {:g} %",
      percent(d.median),
      100 * (1 - d.alpha),
      percent(d.interval.low),
      percent(d.interval.high),
      pairs,
      100 * margin);
}

Finding untimed_case(const std::string& name,
                     PairedTiming::Untimed untimed,
                     bool strict) {
  const bool lost = untimed.head && !untimed.base;
  return {.kind = "clock",
          .name = name,
          .verdict = lost ? "lost" : "not timed",
          .detail = lost ? "a stage of the head failed, was skipped or diverged"
                    : untimed.head
                        ? "a stage failed, was skipped or diverged"
                        : "a stage of the base failed, was skipped or diverged",
          .code = lost     ? ExitCode::accuracy
                  : strict ? ExitCode::inconclusive
                           : ExitCode::good,
          .numbers = nullptr};
}

nlohmann::json numbers_of(const Decision& d,
                          std::size_t pairs,
                          std::uint64_t seed) {
  nlohmann::json numbers{{"pairs", pairs}, {"seed", seed}};
  if (pairs == 0) return numbers;
  numbers["log_ratio"] = d.median;
  numbers["alpha"] = d.alpha;
  if (std::isfinite(d.interval.low) && std::isfinite(d.interval.high))
    numbers["interval"] = {d.interval.low, d.interval.high};
  return numbers;
}

}  // namespace

std::set<std::string> cases_known_to(const fs::path& program,
                                     const Chosen& chosen) {
  const Ended listed = run_child(command(program, "list", chosen, {"--json"}),
                                 {.seconds = kLongestAnswer});
  if (listed.status != 0) refuse_program(ending_of(program.string(), listed));
  try {
    std::set<std::string> names;
    for (const auto& c : nlohmann::json::parse(listed.output))
      names.insert(c.at("name").get<std::string>());
    return names;
  } catch (const nlohmann::json::exception&) {
    refuse_program(program.string() +
                   " does not print a list of cases as JSON");
  }
}

void require_one_processor(const fs::path& base, const fs::path& head) {
  const auto of_base = processor_of(base), of_head = processor_of(head);
  if (of_base.empty() || of_head.empty() || of_base == of_head) return;
  throw UsageError(
      fmt::format("{} is built for {} and {} for {}; times of different "
                  "processors are not compared",
                  base.string(),
                  of_base,
                  head.string(),
                  of_head));
}

Runner timed_run(const PairedTimingOptions& o) {
  return [&o](const fs::path& program, const std::vector<std::string>& cases) {
    const PassingStore passing(o.out);
    const fs::path& out = passing.path();
    std::vector<std::string> flags = {"--jobs=1", "--out=" + out.string()};
    for (const auto& name : cases) flags.push_back("--filter=" + exactly(name));
    output_of(command(program, "run", o.chosen, std::move(flags)));
    const auto all = times(out);
    std::vector<double> of_cases;
    for (const auto& name : cases) {
      const auto at = all.find(name);
      of_cases.push_back(at == all.end()
                             ? std::numeric_limits<double>::quiet_NaN()
                             : at->second);
    }
    return of_cases;
  };
}

PairedTiming time_in_pairs(
    const PairedTimingOptions& o,
    const Runner& run,
    const std::function<void(std::size_t pair, std::size_t left)>& tell) {
  const double begin = now().wall;
  Stream random = Rng::root("gate/pairs", o.seed).stream();
  std::vector<MedianWatch> watches(o.cases.size());
  PairedTiming timing;
  timing.decisions.resize(o.cases.size());
  timing.untimed.resize(o.cases.size());
  std::vector<std::size_t> left(o.cases.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  // What is decided stays so and is not run again.
  for (std::size_t pair = 1; !left.empty() && now().wall - begin < o.seconds;
       ++pair) {
    std::vector<std::string> names;
    for (const std::size_t i : left) names.push_back(o.cases[i]);
    const std::uint64_t draw = random.bits();
    const OneCore core(draw >> 1);
    const bool base_first = (draw & 1) != 0;
    const auto first = run(base_first ? o.base : o.head, names);
    const auto second = run(base_first ? o.head : o.base, names);
    const auto& base = base_first ? first : second;
    const auto& head = base_first ? second : first;
    for (std::size_t k = 0; k < left.size(); ++k) {
      PairedTiming::Untimed& untimed = timing.untimed[left[k]];
      untimed = {.base = !(base[k] > 0), .head = !(head[k] > 0)};
      if (!untimed.base && !untimed.head)
        watches[left[k]].add(math::log(head[k] / base[k]));
    }
    const auto decisions = decide(watches, o.alpha, o.margin);
    for (const std::size_t i : left) timing.decisions[i] = decisions[i];
    std::erase_if(left, [&](std::size_t i) {
      return timing.decisions[i].speed != Speed::inconclusive ||
             timing.untimed[i].base || timing.untimed[i].head;
    });
    if (tell) tell(pair, left.size());
  }
  for (const auto& watch : watches) timing.pairs.push_back(watch.count());
  timing.seconds = now().wall - begin;
  return timing;
}

std::vector<Finding> findings_of(const PairedTimingOptions& o,
                                 const PairedTiming& timing,
                                 bool strict) {
  std::vector<Finding> all;
  for (std::size_t i = 0; i < o.cases.size(); ++i) {
    const Decision& d = timing.decisions[i];
    const bool open = d.speed == Speed::inconclusive;
    if (timing.untimed[i].base || timing.untimed[i].head) {
      all.push_back(untimed_case(o.cases[i], timing.untimed[i], strict));
      continue;
    }
    all.push_back({.kind = "clock",
                   .name = o.cases[i],
                   .verdict = std::string(to_string(d.speed)),
                   .detail = detail_of(d, timing.pairs[i], o.margin),
                   .code = d.speed == Speed::slower ? ExitCode::slower
                           : open && strict         ? ExitCode::inconclusive
                                                    : ExitCode::good,
                   .numbers = numbers_of(d, timing.pairs[i], o.seed)});
  }
  return all;
}

}  // namespace physinv
