#include "suite/gate/instructions.h"

#include <fmt/format.h>

#include <atomic>
#include <charconv>
#include <future>

#include "suite/harness/build_info.h"
#include "suite/harness/child.h"
#include "suite/harness/context.h"
#include "suite/harness/processor.h"
#include "suite/store/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

/// The number that follows `mark`.
std::optional<std::uint64_t> number_after(std::string_view text,
                                          std::string_view mark) {
  auto at = text.find(mark);
  if (at == std::string_view::npos) return {};
  at = text.find_first_not_of(" :", at + mark.size());
  if (at == std::string_view::npos) return {};
  std::uint64_t value = 0;
  const auto [end, error] =
      std::from_chars(text.data() + at, text.data() + text.size(), value);
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

std::vector<std::string> command(Counting counting,
                                 const fs::path& program,
                                 const std::string& profile,
                                 const std::string& name) {
  if (counting == Counting::perf)
    return {program.string(), "--perf", profile, name};
  return {"valgrind",
          "--tool=callgrind",
          "--collect-atstart=no",
          "--toggle-collect=physinv_counted",
          "--callgrind-out-file=/dev/null",
          program.string(),
          profile,
          name};
}

std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const auto at = text.rfind('\n');
  return at == std::string::npos ? text : text.substr(at + 1);
}

std::uint64_t count(Counting counting,
                    const fs::path& program,
                    const std::string& profile,
                    const std::string& name) {
  const Ended ended = run_child(command(counting, program, profile, name));
  const auto counted = counting == Counting::perf
                           ? number_after(ended.output, "instructions")
                           : number_after(ended.errors, "Collected");
  if (ended.status != 0 || counted.value_or(0) == 0)
    throw EnvironmentError(fmt::format(
        "cannot count the instructions of {}: {} exited with {}: {}",
        name,
        counter_name(counting),
        ended.status,
        last_line(ended.errors)));
  return *counted;
}

}  // namespace

std::string counter_name(Counting counting) {
  const std::string_view here = build_info().instruction_set;
  return fmt::format("{} {}",
                     counting == Counting::perf ? "perf" : "callgrind",
                     processor_kind(here) == "x86-64" ? "x86-64-v3" : here);
}

std::string counted_processor(std::string_view counter) {
  const auto at = counter.rfind(' ');
  return std::string(
      at == counter.npos ? "x86-64" : processor_kind(counter.substr(at + 1)));
}

std::string not_comparable(std::string_view counter,
                           std::string_view instruction_set) {
  const auto there = counted_processor(counter);
  const auto here = processor_kind(instruction_set);
  if (there == here) return "";
  return fmt::format(
      "instruction counts were recorded on {} and are not compared on {}",
      there,
      here);
}

bool can_count(Counting counting, const fs::path& program, std::string* why) {
  if (!is_there(program)) {
    *why = fmt::format(
        "there is no {}; build the target physinv-count for x86-64-v3 or with "
        "tests",
        program.string());
    return false;
  }
  const bool perf = counting == Counting::perf;
  const Ended ended =
      perf ? run_child({program.string(), "--perf"})
           : run_child({"valgrind", "--tool=callgrind", "--version"});
  if (ended.status == 0) return true;
  *why = perf ? "the kernel provides no instruction counter (" +
                    last_line(ended.errors) + ")"
              : "valgrind is not installed";
  return false;
}

std::optional<Counting> find_counting(const fs::path& program,
                                      std::string* why) {
  for (const Counting counting : {Counting::perf, Counting::callgrind})
    if (can_count(counting, program, why)) return counting;
  return {};
}

CountTable count_instructions(Counting counting,
                              const fs::path& program,
                              const std::string& profile,
                              const std::vector<std::string>& cases) {
  CountTable table{.counter = counter_name(counting),
                   .lines = std::vector<CountLine>(cases.size())};
  // They do not depend on what else runs.
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < cases.size(); i = next++)
      table.lines[i] = {cases[i], count(counting, program, profile, cases[i])};
  };
  std::vector<std::future<void>> workers;
  for (int w = 0; w < available_cores(); ++w)
    workers.push_back(std::async(std::launch::async, work));
  for (auto& worker : workers) worker.get();
  return table;
}

Finding judge(const CountLine& before, const CountLine& now) {
  const double ratio = static_cast<double>(now.instructions) /
                       static_cast<double>(before.instructions);
  const bool slower = ratio > 1 + kInstructionThreshold;
  const bool faster = ratio < 1 / (1 + kInstructionThreshold);
  return {.kind = "instructions",
          .name = now.name,
          .verdict = slower   ? "slower"
                     : faster ? "faster"
                              : "equal",
          .detail = fmt::format("{} -> {} ({:+.3f} %, allowed {:g} %)",
                                before.instructions,
                                now.instructions,
                                100 * (ratio - 1),
                                100 * kInstructionThreshold),
          .code = slower ? ExitCode::slower : ExitCode::good,
          .numbers = {{"before", before.instructions},
                      {"now", now.instructions},
                      {"ratio", ratio}}};
}

}  // namespace physinv
