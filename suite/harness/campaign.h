/// A campaign: cases in, a finished store out.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "suite/harness/case.h"
#include "suite/harness/prepare.h"
#include "suite/harness/screen.h"
#include "suite/store/plan.h"

namespace physinv {

struct CampaignOptions {
  std::filesystem::path out;
  int jobs = 1;     ///< worker processes; several take the largest case first
  int threads = 1;  ///< inside a case
  /// Seconds after which no further case is started; 0 for none.
  double time_budget = 0;
  /// With a budget: the queue (indices of cases) as it should continue, given
  /// the final median losses of the cases that finished.
  std::function<std::vector<std::size_t>(
      std::vector<std::size_t> queue,
      const std::map<std::size_t, double>& finished)>
      order;
  /// With a budget, if known: what each case will take. One that would not
  /// end in time is not started.
  std::vector<double> expected_seconds;
  /// Reuse finished stages of the same content key; otherwise what the store
  /// holds of these cases, and of no other, is deleted first.
  bool resume = true;
  bool trace = false;  ///< record hashes of all iterates
  /// Once no case waits, give free cores (of jobs x threads) to running cases:
  /// stages that save their state continue in more threads.
  bool share_cores = false;
  /// Seconds that a case runs before it is asked for that.
  double share_seconds = 5;
  /// Seconds between the checkpoints of a running stage.
  double checkpoint_seconds = 60;
  /// Seconds after which a worker is named that reports nothing and computes
  /// nothing.
  double still_seconds = 60;
  /// Take the lock of the store from its owner, where there is no flock.
  bool break_lock = false;
  /// Run with data one ulp off, as `prepare` drew them.
  bool disturb = false;
  /// The unsharded campaign, in order; empty if it is this one.
  std::vector<PlannedCase> campaign;
};

/// (day, revision) that reused stages come from, and how many.
using Origins = std::map<std::pair<std::string, std::string>, int>;
std::string to_text(const Origins& origins);

struct CampaignResult {
  std::size_t stages_run = 0, stages_reused = 0;
  std::vector<std::string> failed;   ///< "case: why"
  std::vector<std::string> not_run;  ///< names, out of time or interrupted
  Origins origins;
  std::vector<CaseRecord> cases;  ///< all of the store, without curves
  bool interrupted = false;
  double seconds = 0;    ///< wall, all of it
  double cpu = 0;        ///< CPU seconds of all processes
  double stage_cpu = 0;  ///< of these, in stages
  /// Of drawing the cases' data and, in stages, training examples.
  double data_cpu = 0;
  /// In stages, for curves, metrics and final losses: what methods do not do.
  double evaluation = 0;
  double bookkeeping = 0;  ///< CPU seconds for all but stages and data
  double waiting = 0;      ///< wall seconds for the disk, without CPU
};

/// The queue (indices of cases) by falling work, so that no worker has the
/// largest case to itself at the end (Graham 1969); equal ones keep their
/// order.
std::vector<std::size_t> largest_first(std::vector<std::size_t> queue,
                                       const std::vector<double>& work);

/// Runs what the store does not hold. Only this process writes to it; finished
/// stages are written together, every two seconds (or as often as running
/// stages save their state, if that is more often). SIGINT and SIGTERM end the
/// campaign with what has finished; running stages save their state if they
/// can. A case whose worker is killed from outside is tried again.
/// `options_json` enters the context.
CampaignResult run_campaign(Prepared prepared,
                            const CampaignOptions& options,
                            const nlohmann::json& options_json,
                            const Screen& screen);

/// What `run_campaign` would do: one line per stage and a sum. A case without
/// content keys has not run.
void dry_run(const Prepared& prepared,
             const CampaignOptions& options,
             const Screen& screen);

/// Table: per experiment its methods, cases and stages, how many of these
/// diverged or failed, and the time of all.
std::string summary_table(const std::vector<CaseRecord>& cases,
                          std::size_t room);

}  // namespace physinv
