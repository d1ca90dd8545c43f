#include "suite/harness/run_stage.h"

#include <sys/resource.h>

#include <algorithm>
#include <utility>

#include "suite/core/clock.h"
#include "suite/core/float_environment.h"
#include "suite/core/hash.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/harness/keys.h"
#include "suite/harness/study.h"

namespace physinv {
namespace {

std::uint64_t peak_rss() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

/// Missing per-example findings get neutral values; wrong sizes are a bug of
/// the stage.
void check_outcome(Outcome& out, const Oracle& oracle) {
  const Index n = oracle.count();
  SUITE_CHECK(out.x.rows() == oracle.shape().unknowns && out.x.cols() == n,
              "a stage leaves one estimate per example");
  if (out.status.empty())
    out.status.assign(static_cast<std::size_t>(n), Status::maxiter);
  if (out.iterations.size() == 0) out.iterations.setZero(n);
  if (out.evaluations.size() == 0) out.evaluations.setZero(n);
  SUITE_CHECK(static_cast<Index>(out.status.size()) == n &&
                  out.iterations.size() == n && out.evaluations.size() == n,
              "a stage leaves one status per example");
}

/// What a stage that failed has run. Who runs a problem itself tells its counts
/// at its end alone: then nobody knows them.
Counts counts_of_failure(const Oracle& oracle) {
  return oracle.handed_out() ? unknown_counts() : oracle.counts();
}

/// The experiment's setting with the networks that the stage names, so that no
/// other can enter its numbers.
Setting setting_for(const Stage& stage, Setting setting) {
  if (!contains(stage.networks(), Networks::predictor)) setting.predictor = {};
  if (!contains(stage.networks(), Networks::surrogate)) setting.surrogate = {};
  return setting;
}

/// Every final loss of every method is evaluated by Oracle::measure.
void fill(StageRecord& r,
          const Case& c,
          const Outcome& out,
          Oracle& oracle,
          Probe& probe) {
  r.counts = oracle.counts();
  r.loss.resize(oracle.count());
  if (!probe.knows_losses(out.x, r.loss)) oracle.measure(out.x, r.loss);
  const Index setting = c.experiment->setting.recorded;
  const Index recorded =
      setting > 0 ? std::min(setting, oracle.count()) : oracle.count();
  r.x = out.x.leftCols(recorded);
  r.status = out.status;
  r.example_iterations = out.iterations;
  r.example_evaluations = out.evaluations;
  r.arrays = out.arrays;
  r.stop = out.stop;
  r.message = out.message;
  if (!r.loss.array().isFinite().any()) r.stop = Stop::diverged;
  r.iterations = probe.iteration();
  r.clocks = probe.clocks();
  r.curve = probe.curve();
  r.curve.loss.conservativeResize(recorded, Eigen::NoChange);
  r.buffer_bytes = out.bytes + oracle.bytes();
  r.rss_bytes = peak_rss();
}

}  // namespace

void run_stage(const Case& c,
               std::size_t position,
               std::optional<Outcome>& previous,
               bool trace,
               const Probe::Observer& observer,
               Threads* threads,
               Checkpoint* checkpoint,
               StageRecord& record) {
  set_default_float_environment();  // whatever ran before
  const Stage& stage = *c.method->chain[position];
  const Setting setting = setting_for(stage, c.experiment->setting);
  const Rng root = root_of(c.info.experiment, c.info.seed);
  const Seconds begin = now();
  Oracle oracle(c.experiment->problem, c.info.n, root, stage.needs(), threads);
  const Seconds made = now();
  Probe probe(oracle,
              c.stage_iterations[position],
              tracked_examples(oracle.shape().unknowns));
  if (trace) probe.follow();
  if (observer) probe.set_observer(observer);
  StageRun run{.oracle = oracle,
               .probe = probe,
               .setting = setting,
               .previous = previous ? &*previous : nullptr,
               .network_init = root.child("network/init"),
               .batches = root.child("batches"),
               .method = root.child("method/" +
                                    hex64(hash_text(recipe_text(c, position)))),
               .iterations = c.stage_iterations[position],
               .precision = c.info.precision,
               .threads = threads,
               .checkpoint = checkpoint};
  Outcome out;
  try {
    out = stage.run(run);
    set_default_float_environment();  // its losses are of no other
    probe.end();
    check_outcome(out, oracle);
  } catch (...) {
    set_default_float_environment();
    probe.end();
    record.clocks = probe.clocks();
    record.clocks.setup += made - begin;
    record.counts = counts_of_failure(oracle);
    throw;
  }
  fill(record, c, out, oracle, probe);
  record.clocks.setup += made - begin;
  if (trace) record.trajectory = hex64(probe.trajectory());
  previous = std::move(out);
}

Counts unknown_counts() {
  Counts counts;
  for (std::size_t i = 0; i < kCounters; ++i)
    counts.forget(static_cast<Counter>(i));
  return counts;
}

Outcome as_outcome(StageRecord record) {
  return {.x = std::move(record.x),
          .status = std::move(record.status),
          .iterations = std::move(record.example_iterations),
          .evaluations = std::move(record.example_evaluations),
          .stop = record.stop,
          .message = std::move(record.message),
          .arrays = std::move(record.arrays)};
}

}  // namespace physinv
