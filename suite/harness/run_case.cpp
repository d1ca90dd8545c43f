#include "suite/harness/run_case.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <new>
#include <optional>
#include <utility>

#include "suite/core/hash.h"
#include "suite/harness/keys.h"

namespace physinv {
namespace {

std::uint64_t peak_rss() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

/// A finished stage as the next one sees it.
Outcome as_outcome(StageRecord record) {
  return {.x = std::move(record.x),
          .status = std::move(record.status),
          .iterations = std::move(record.example_iterations),
          .evaluations = std::move(record.example_evaluations),
          .stop = record.stop,
          .message = std::move(record.message),
          .arrays = std::move(record.arrays)};
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

StageRecord blank(const Case& c, Index position, const std::string& revision) {
  const auto at = static_cast<std::size_t>(position);
  const Stage& stage = *c.method->chain[at];
  StageRecord r;
  r.case_name = c.info.name;
  r.stage = stage.name();
  r.key = at < c.info.keys.size() ? c.info.keys[at] : "";
  r.position = position;
  r.options = stage.options();
  r.revision = revision;
  return r;
}

class Runner {
 public:
  Runner(const Case& c,
         const RunOptions& options,
         Threads* threads,
         const CaseHooks& hooks)
      : case_(c),
        options_(options),
        threads_(threads),
        hooks_(hooks),
        root_(Rng::root(c.info.experiment, c.info.seed)) {}

  /// Runs one stage; `previous` becomes its outcome.
  StageRecord run(Index position, std::optional<Outcome>& previous) {
    const auto at = static_cast<std::size_t>(position);
    const Stage& stage = *case_.method->chain[at];
    StageRecord record = blank(case_, position, options_.revision);
    Oracle oracle(case_.experiment->problem,
                  case_.info.n,
                  root_,
                  stage.needs(),
                  threads_);
    Probe probe(oracle,
                case_.stage_iterations[at],
                tracked_examples(oracle.shape().unknowns));
    std::uint64_t trajectory = hash_text("trajectory");
    listen(probe, trajectory);
    StageRun run{.oracle = oracle,
                 .probe = probe,
                 .setting = case_.experiment->setting,
                 .previous = previous ? &*previous : nullptr,
                 .network_init = root_.child("network/init"),
                 .batches = root_.child("batches"),
                 .method = root_.child(
                     "method/" + hex64(hash_text(recipe_text(case_, at)))),
                 .iterations = case_.stage_iterations[at],
                 .precision = case_.info.precision,
                 .threads = threads_};
    Outcome out = stage.run(run);
    probe.end();
    check_outcome(out, oracle);
    fill(record, out, oracle, probe);
    if (options_.trace) record.trajectory = hex64(trajectory);
    previous = std::move(out);
    return record;
  }

 private:
  void listen(Probe& probe, std::uint64_t& trajectory) {
    if (options_.trace) {
      probe.set_trace([&trajectory](const void* data, std::size_t bytes) {
        trajectory = hash_bytes(data, bytes, trajectory);
      });
    }
    if (hooks_.progress) {
      double last = now().wall;
      probe.set_observer([this, last](Index i, VectorIn<double> loss) mutable {
        const double t = now().wall;
        if (t - last < 0.1) return;
        last = t;
        hooks_.progress(i, median_finite(loss));
      });
    }
  }

  /// Every final loss of every method is evaluated by this one call.
  void fill(StageRecord& r, const Outcome& out, Oracle& oracle, Probe& probe) {
    r.counts = oracle.counts();
    r.loss.resize(oracle.count());
    oracle.measure(out.x, r.loss);
    const Index setting = case_.experiment->setting.recorded;
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
    r.crowded = options_.crowded;
    r.finished = utc_now();
  }

  const Case& case_;
  const RunOptions& options_;
  Threads* threads_;
  const CaseHooks& hooks_;
  Rng root_;
};

/// What the current exception says.
std::string exception_text() {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return "out of memory";
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "an exception of unknown type";
  }
}

}  // namespace

std::string utc_now() {
  const std::time_t t = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&t, &utc);
  char text[32];
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

double median_finite(VectorIn<double> values) {
  std::vector<double> v;
  for (Index i = 0; i < values.size(); ++i)
    if (std::isfinite(values(i))) v.push_back(values(i));
  if (v.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

StageRecord lost_stage(const Case& c,
                       Index position,
                       Stop stop,
                       std::string message,
                       const std::string& revision) {
  StageRecord r = blank(c, position, revision);
  r.stop = stop;
  r.message = std::move(message);
  r.finished = utc_now();
  return r;
}

void run_case(const Case& c,
              std::vector<StageRecord> earlier,
              const RunOptions& options,
              Threads* threads,
              const CaseHooks& hooks) {
  Runner runner(c, options, threads, hooks);
  const auto stages = static_cast<Index>(c.method->chain.size());
  auto position = static_cast<Index>(earlier.size());
  std::optional<Outcome> previous;
  if (!earlier.empty()) previous = as_outcome(std::move(earlier.back()));
  std::string failed;
  for (; position < stages; ++position) {
    StageRecord record;
    if (!failed.empty()) {
      record = lost_stage(
          c, position, Stop::skipped, failed + " failed", options.revision);
    } else {
      if (hooks.started) hooks.started(position);
      try {
        record = runner.run(position, previous);
      } catch (...) {
        record = lost_stage(
            c, position, Stop::failed, exception_text(), options.revision);
        failed = record.stage;
      }
    }
    if (hooks.finished) hooks.finished(record);
  }
}

}  // namespace physinv
