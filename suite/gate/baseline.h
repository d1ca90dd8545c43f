/// A baseline: the results of a campaign, as a text that a reviewer reads in a
/// diff. A header, a line per stage (stage_line.h), the instructions of some
/// cases, and a checksum of it all:
///
///   physinv-bench baseline 1
///   profile smoke
///   bits Eigen-3.4.0 SLEEF-3.5.1 ...
///   build GNU 12.2.0 -O3 ...
///   stages 157
///   jpo/billiards/bfgs/n=4/seed=0/solve trajectory=...
///   instructions 6 callgrind x86-64-v3
///   jpo/billiards/bfgs/n=4/seed=0 12345678
///   checksum 0123abcd
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "suite/gate/stage_line.h"

namespace physinv {

/// How a baseline's cases were chosen, in the words of `run`.
struct Chosen {
  std::string profile, seeds;
  std::vector<std::string> filters, sets;
};

/// Instructions that the stages of one case execute.
struct CountLine {
  std::string name;  ///< of the case
  std::uint64_t instructions = 0;
};

/// Counts of one counter on one instruction set, in nothing else comparable.
struct CountTable {
  std::string counter;  ///< "callgrind x86-64-v3"; empty: not counted
  std::vector<CountLine> lines;
};

struct Baseline {
  Chosen chosen;
  std::string bits;      ///< for the same, the same bits are promised
  std::string build;     ///< for the same, instructions compare
  std::string numerics;  ///< fingerprint of the sources
  std::string machine, revision, date;
  std::vector<StageLine> stages;
  CountTable counts;
};

/// Header of this build on this machine, today.
Baseline blank_baseline(Chosen chosen);

/// Libraries, and flags if any, that decide about bits. Compiler, optimization
/// and width of registers do not.
std::string bits_text();

/// Compiler, flags and libraries that decide about instructions of one width.
std::string build_text();

std::string to_text(const Baseline& baseline);

/// StoreError if a byte is wrong, UnreadableInput if it is not a baseline or
/// one of a newer version. `where` is for messages.
Baseline parse_baseline(const std::string& text, const std::string& where);
Baseline read_baseline(const std::filesystem::path& path);

}  // namespace physinv
