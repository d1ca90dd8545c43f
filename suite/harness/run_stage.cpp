#include "suite/harness/run_stage.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "suite/core/clock.h"
#include "suite/core/float_environment.h"
#include "suite/core/hash.h"
#include "suite/core/nan.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/harness/keys.h"
#include "suite/harness/sources.h"
#include "suite/harness/study.h"
#include "suite/store/storable.h"

namespace physinv {
namespace {

std::uint64_t peak_rss() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

[[noreturn]] void refuse(const std::string& what) {
  throw std::runtime_error(what);
}

bool is_end(Stop stop) {
  return stop == Stop::converged || stop == Stop::iterations ||
         stop == Stop::diverged;
}

/// Missing per-example findings get neutral values. Throws if the stage says
/// that it failed, or leaves what is not one for each example.
void check_outcome(Outcome& out, const Oracle& oracle) {
  const Index n = oracle.count(), unknowns = oracle.shape().unknowns;
  if (out.stop == Stop::failed || out.stop == Stop::skipped)
    refuse(out.message.empty()
               ? "the stage reported a failure without a message"
               : out.message);
  if (!is_end(out.stop))
    refuse(fmt::format("the stage ended with the invalid code {}",
                       static_cast<int>(out.stop)));
  if (out.x.rows() != unknowns || out.x.cols() != n)
    refuse(fmt::format(
        "the stage returned {} estimates of {} unknowns; expected {} of {}",
        out.x.cols(),
        out.x.rows(),
        n,
        unknowns));
  if (out.status.empty())
    out.status.assign(static_cast<std::size_t>(n), Status::maxiter);
  if (static_cast<Index>(out.status.size()) != n)
    refuse(fmt::format("the stage returned {} statuses for {} examples",
                       out.status.size(),
                       n));
  if (out.iterations.size() == 0) out.iterations.setZero(n);
  if (out.evaluations.size() == 0) out.evaluations.setZero(n);
}

/// Iterations and evaluations of a method from outside are what was counted;
/// its own numbers are stored next to them as arrays. Evaluations are the mean
/// of the examples, as along the curve.
void take_counts(Outcome& out, const Oracle& oracle, const Probe& probe) {
  const auto take = [&](const char* name, Vector<double>& own, double counted) {
    if (own.size() > 0) out.arrays[ArrayKey::own(name)] = own.transpose();
    own.setConstant(oracle.count(), counted);
  };
  const Counts& counts = oracle.counts();
  const auto all =
      static_cast<double>(counts[Counter::forward] + counts[Counter::vjp]);
  take("claimed_iterations",
       out.iterations,
       static_cast<double>(probe.iteration()));
  take("claimed_evaluations",
       out.evaluations,
       all / static_cast<double>(oracle.count()));
}

/// How many iterations beyond its budget a method says that an example took,
/// where it says anything.
void note_overrun(Outcome& out, Index budget) {
  const auto claimed = out.arrays.find(ArrayKey::own("claimed_iterations"));
  if (claimed == out.arrays.end()) return;
  const Batch<double> beyond =
      claimed->second.array() - static_cast<double>(budget);
  out.arrays[ArrayKey::own("overrun")] =
      (beyond.array() > 0).select(beyond, 0.0);
}

/// The numbers decide before what the stage says of them: an estimate that is
/// not finite has no loss, a sample without a finite loss ends as `nonfinite`,
/// and no stage with such a sample has converged.
void settle(StageRecord& r, Outcome& out) {
  for (Index i = 0; i < r.loss.size(); ++i) {
    if (std::isfinite(r.loss(i)) && !out.x.col(i).allFinite())
      r.loss(i) = std::numeric_limits<double>::quiet_NaN();
    if (!std::isfinite(r.loss(i)))
      out.status[static_cast<std::size_t>(i)] = Status::nonfinite;
  }
  const auto finite = r.loss.array().isFinite();
  if (!finite.any()) {
    out.stop = Stop::diverged;
  } else if (out.stop == Stop::converged && !finite.all()) {
    out.stop = Stop::iterations;
  }
}

/// Every NaN that is recorded is the same bits, whichever processor made it.
void unify(StageRecord& r, Outcome& out) {
  unify_nan(r.loss);
  unify_nan(out.x);
  for (auto& [name, array] : out.arrays) unify_nan(array);
}

/// What a stage that failed has run. A method that runs the problem itself
/// reports its counts only at its end: then they are not known.
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
void fill(
    StageRecord& r, const Case& c, Outcome& out, Oracle& oracle, Probe& probe) {
  r.counts = oracle.counts();
  r.loss.resize(oracle.count());
  if (!probe.knows_losses(out.x, r.loss)) oracle.measure(out.x, r.loss);
  settle(r, out);
  unify(r, out);
  const Index setting = c.experiment->setting.recorded;
  const Index recorded =
      setting > 0 ? std::min(setting, oracle.count()) : oracle.count();
  r.x = out.x.leftCols(recorded);
  r.status = out.status;
  r.example_iterations = out.iterations;
  r.example_evaluations = out.evaluations;
  r.arrays = out.arrays;
  r.stop = out.stop;
  r.message = out.message = bounded_message(std::move(out.message));
  r.iterations = probe.iteration();
  r.clocks = probe.clocks();
  r.curve = probe.curve();
  r.curve.loss.conservativeResize(recorded, Eigen::NoChange);
  unify_nan(r.curve.loss);
  unify_nan(r.curve.x);
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
    if (is_from_outside(stage)) take_counts(out, oracle, probe);
    check_outcome(out, oracle);
    note_overrun(out, c.stage_iterations[position]);
  } catch (...) {
    set_default_float_environment();
    probe.end();
    record.clocks = probe.clocks();
    record.clocks.setup += made - begin;
    record.counts = counts_of_failure(oracle);
    throw;
  }
  fill(record, c, out, oracle, probe);
  if (const auto flaw = flaw_of_new(record, c.method->chain.size());
      !flaw.empty())
    refuse("the stage returned values that cannot be stored: " + flaw);
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
