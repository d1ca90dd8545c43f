/// Runs one stage and fills its record with everything that is a result. All
/// numbers pass through here, so these two files are part of every content
/// key: what only names, shows or counts is elsewhere.
#pragma once

#include <optional>

#include "suite/core/method.h"
#include "suite/core/probe.h"
#include "suite/core/threads.h"
#include "suite/harness/case.h"

namespace physinv {

/// The stage at `position` of a chain; `previous` is the outcome of the stage
/// before it, if there is one, and becomes this one's. With `trace`, the record
/// gets a hash of every iterate. `observer` may be empty, `checkpoint`
/// null. Of a stage that throws, the record gets times and counts until then.
void run_stage(const Case& c,
               std::size_t position,
               std::optional<Outcome>& previous,
               bool trace,
               const Probe::Observer& observer,
               Threads* threads,
               Checkpoint* checkpoint,
               StageRecord& record);

/// Those of a stage that reports nothing of what it ran.
Counts unknown_counts();

/// A finished stage as the next one sees it.
Outcome as_outcome(StageRecord record);

}  // namespace physinv
