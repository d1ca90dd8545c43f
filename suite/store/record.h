/// The record of a case: what the journal, the HDF5 file and results.json say.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "suite/core/arrays.h"
#include "suite/core/batch.h"
#include "suite/core/clock.h"
#include "suite/core/counts.h"
#include "suite/core/curve.h"
#include "suite/core/options.h"
#include "suite/core/stop.h"

namespace physinv {

/// What the columns of an array of the problem are.
struct Meaning {
  std::string names;       ///< "v_x, v_y", or of a field "temperature (y, x)"
  std::string unit = "1";  ///< of all of them
};

/// What a case is about. It is in the case's file and decides nothing.
struct About {
  std::string problem;  ///< billiards
  std::string paper;    ///< "Ann Ames: Title. Venue, 2022. arXiv:2203.10131"
  std::string arxiv;    ///< 2203.10131
  Meaning unknowns, observations, given;
};

/// What a case is; all of it known before it runs.
struct CaseInfo {
  std::string name;        ///< jpo/billiards/jpo/n=64/seed=3
  std::string experiment;  ///< jpo/billiards
  std::string method;      ///< jpo
  std::string profile;     ///< quick
  Index n = 0;
  std::uint64_t seed = 0;
  Precision precision = Precision::f32;
  std::vector<std::string> stages;  ///< names in the order of the chain
  std::vector<std::string> keys;    ///< content key of each stage
  About about = {};
};

/// Where and how a stage ran: what its times depend on, and its numbers do not.
struct RunContext {
  std::string profile;  ///< quick; empty in records of older versions
  std::string host, processor, instruction_set;
  int threads = 0, jobs = 0;  ///< 0: not known
  /// Where the stage ran with other threads: "2 from iteration 340"
  /// (thread_log.h).
  std::string thread_changes = {};
  bool operator==(const RunContext&) const = default;
};

/// One finished stage.
struct StageRecord {
  std::string case_name, stage, key;
  Index position = 0;  ///< in the chain
  Options options;     ///< that decide the result
  Stop stop = Stop::iterations;
  std::string message;

  Index iterations = 0;  ///< run; a batch of BFGS runs counts its rounds
  Clocks clocks;
  Counts counts;
  std::uint64_t buffer_bytes = 0;  ///< peak bytes of the stage's buffers
  std::uint64_t rss_bytes = 0;     ///< peak resident set of its process
  bool crowded = false;    ///< wall times measure no speed (see crowded.h)
  std::string finished;    ///< UTC date and time, ISO 8601
  std::string revision;    ///< git revision it ran from, "+dirty" if so
  std::string trajectory;  ///< hash of all iterates, if traced
  RunContext run;

  Batch<double> x;             ///< unknowns x examples
  Vector<double> loss;         ///< of x, evaluated again in double
  std::vector<Status> status;  ///< per example
  Vector<double> example_iterations, example_evaluations;
  Curve curve;
  Arrays arrays;  ///< method's own findings

  /// Solving again, only for its times, see repetitions.h; not in the journal.
  std::vector<Seconds> repeated;
};

/// Did it end by itself? A divergence is a result, too.
inline bool has_result(const StageRecord& stage) {
  return stage.stop != Stop::failed && stage.stop != Stop::skipped;
}

/// Did it do what it was asked for? A stage that failed, was skipped or
/// diverged spent less and gained nothing: its costs, time and work, do not
/// count.
constexpr bool completes(Stop stop) {
  return stop == Stop::converged || stop == Stop::iterations;
}
/// Did it end so that its time counts?
inline bool has_time(const StageRecord& stage) { return completes(stage.stop); }

/// Problem data of a case, so that results can be verified alone.
struct CaseData {
  std::string hash;  ///< content hash
  Batch<double> x, y, given;
};

struct CaseRecord {
  CaseInfo info;
  CaseData data;
  std::vector<StageRecord> stages;  ///< finished ones, in chain order
};

/// Which profile a stage ran for; one of an older version has its case's.
inline const std::string& profile_of(const CaseRecord& c,
                                     const StageRecord& stage) {
  return stage.run.profile.empty() ? c.info.profile : stage.run.profile;
}

}  // namespace physinv
