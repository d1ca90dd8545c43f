/// Instructions that cases execute: nearly the same in every run, so that 1 %
/// more is seen on a machine that is not quiet. Counted by the processor where
/// the kernel lets us, else by valgrind's callgrind.
///
/// The program physinv-count runs one case on one thread, narrow registers
/// alone. What a count cannot see: waiting for memory, AVX-512, threads.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "suite/gate/baseline.h"
#include "suite/gate/gate_report.h"

namespace physinv {

enum class Counting { perf, callgrind };
/// As a baseline calls it, with what this build counts: "callgrind x86-64-v3",
/// whatever the width of the other programs; "callgrind aarch64".
std::string counter_name(Counting counting);

/// Of which processor a counter's instructions are: "x86-64", "aarch64". A
/// name without an instruction set is of x86-64.
std::string counted_processor(std::string_view counter);

/// Empty where a program of `instruction_set` may compare its instructions
/// with those of `counter`; else why not, for the gate's line.
std::string not_comparable(std::string_view counter,
                           std::string_view instruction_set);

/// Can `program` (physinv-count) be counted so? If not, `why` says it.
bool can_count(Counting counting,
               const std::filesystem::path& program,
               std::string* why);

/// The first that works of perf and callgrind.
std::optional<Counting> find_counting(const std::filesystem::path& program,
                                      std::string* why);

/// Throws EnvironmentError if a case cannot be run.
CountTable count_instructions(Counting counting,
                              const std::filesystem::path& program,
                              const std::string& profile,
                              const std::vector<std::string>& cases);

inline constexpr double kInstructionThreshold = 0.01;

/// Slower by more than the threshold is a failure; names agree.
Finding judge(const CountLine& before, const CountLine& now);

}  // namespace physinv
