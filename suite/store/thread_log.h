/// How many threads a stage ran with, and from which iteration on.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "suite/core/batch.h"

namespace physinv {

/// Pairs (iteration, threads) by rising iteration: so many threads from there
/// on. Empty where nothing is known, as in states of older versions.
using ThreadLog = std::vector<std::pair<Index, int>>;

/// From `iteration` on there are so many threads.
void note_threads(ThreadLog& log, Index iteration, int threads);

/// "2 from iteration 340, 4 from iteration 500": what differs from the `usual`
/// number; empty if nothing does.
std::string changes_text(const ThreadLog& log, int usual);

/// Is it what `note_threads` makes?
bool is_thread_log(const ThreadLog& log);

}  // namespace physinv
