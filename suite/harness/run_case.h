/// Runs the chain of one case, here and now. Exceptions become stages that
/// failed; the stages after them are skipped.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "suite/core/threads.h"
#include "suite/harness/case.h"
#include "suite/harness/checkpoint_file.h"

namespace physinv {

struct RunOptions {
  /// Threads that a case of the campaign has: a stage that ran with others is
  /// marked. 0: any number is right.
  int threads = 0;
  bool crowded = false;  ///< every stage: more workers x threads than cores
  bool trace = false;    ///< hash every iterate
  bool disturb = false;  ///< data one ulp off, see `disturb_data`
  std::string revision;  ///< for the record
  CheckpointOptions checkpoints = {};
};

/// The precision in which most of a case is computed: what an ulp of its data
/// is.
Precision working_precision(const Case& c);

/// Called while a case runs, unless they are empty.
struct CaseHooks {
  std::function<void(Index position)> started;
  /// At points of the curve: iterations done, median loss of the examples.
  std::function<void(Index iteration, double loss)> progress;
  std::function<void(const StageRecord&)> finished;
};

/// Runs the stages that `earlier` (a beginning of the chain) does not hold.
/// Every random stream comes from hash(experiment, seed); the stream
/// `method/<id>` has the content of the chain up to the stage as its id, so
/// that chains sharing a beginning share its results. Throws StageLeft where
/// options.checkpoints says so: in a stage that saved its state, or between
/// two.
void run_case(const Case& c,
              std::vector<StageRecord> earlier,
              const RunOptions& options,
              Threads* threads,
              const CaseHooks& hooks);

/// The record of a stage without a result. What a stage that
/// failed spent is not known, that of one that was skipped is nothing.
StageRecord lost_stage(const Case& c,
                       Index position,
                       Stop stop,
                       std::string message,
                       const std::string& revision);

/// Now, UTC, ISO 8601 to the second.
std::string utc_now();

/// Median of the finite entries; NaN if there are none.
double median_finite(VectorIn<double> values);

}  // namespace physinv
