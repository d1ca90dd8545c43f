/// Times of solving stages again, in repetitions.json of a directory of
/// results. The results of these runs were the same and are not kept.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "suite/store/record.h"

namespace physinv {

/// By "case/stage key", so that those of other options or sources count for
/// nothing.
using Repetitions = std::map<std::string, std::vector<Seconds>>;

/// repetitions.json of a directory of results; empty if there is none.
Repetitions read_repetitions(const std::filesystem::path& directory);
/// The same of a file's bytes; `path` is for messages. StoreError if they are
/// damaged.
Repetitions parse_repetitions(std::string_view bytes,
                              const std::filesystem::path& path);
void write_repetitions(const std::filesystem::path& directory,
                       const Repetitions& repetitions);

/// Enters them into the stages that they are of.
void add_repetitions(std::vector<CaseRecord>& cases,
                     const Repetitions& repetitions);

/// Seconds of solving, those of the recorded run first.
std::vector<double> solving_times(const StageRecord& stage,
                                  double Seconds::*clock);
/// The median of each clock: what a table shows.
Seconds solving_time(const StageRecord& stage);

}  // namespace physinv
