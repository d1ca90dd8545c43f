#include "suite/harness/run_case.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <new>
#include <optional>
#include <utility>

#include "suite/core/clock.h"
#include "suite/core/disturbance.h"
#include "suite/core/median.h"
#include "suite/core/probe.h"
#include "suite/harness/run_stage.h"
#include "suite/harness/sources.h"
#include "suite/results/crowded.h"
#include "suite/store/storable.h"

namespace physinv {
namespace {

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

/// Reports the progress of a stage, ten times a second at most.
Probe::Observer observer(const CaseHooks& hooks) {
  if (!hooks.progress) return {};
  return [&hooks, last = now().wall](Index i, VectorIn<double> loss) mutable {
    const double t = now().wall;
    if (t - last < 0.1) return;
    last = t;
    hooks.progress(i, median_finite(loss));
  };
}

/// "file.cpp:12: what" with the file's path from the root of its sources.
std::string without_folders(const std::string& text) {
  const auto colon = text.find(':');
  return colon == std::string::npos
             ? text
             : source_name(text.substr(0, colon)) + text.substr(colon);
}

/// What the current exception says.
std::string exception_text() {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return "out of memory";
  } catch (const ContractError& error) {
    return without_folders(error.what());
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
  return median(std::move(v));
}

Precision working_precision(const Case& c) {
  const auto& chain = c.method->chain;
  const bool chosen =
      std::any_of(chain.begin(), chain.end(), [](const auto& stage) {
        return stage->has_precision();
      });
  return chosen ? c.info.precision : Precision::f64;
}

StageRecord lost_stage(const Case& c,
                       Index position,
                       Stop stop,
                       std::string message,
                       const std::string& revision) {
  StageRecord r = blank(c, position, revision);
  r.stop = stop;
  r.message = bounded_message(std::move(message));
  r.finished = utc_now();
  if (stop == Stop::failed) r.counts = unknown_counts();
  return r;
}

void run_case(const Case& c,
              std::vector<StageRecord> earlier,
              const RunOptions& options,
              Threads* threads,
              const CaseHooks& hooks) {
  disturb_data(options.disturb ? std::optional(working_precision(c))
                               : std::nullopt);
  const auto stages = static_cast<Index>(c.method->chain.size());
  const int count = threads == nullptr ? 1 : threads->count();
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
        record = blank(c, position, options.revision);
        CheckpointFile checkpoint(options.checkpoints, record, count);
        const auto run = [&] {
          run_stage(c,
                    static_cast<std::size_t>(position),
                    previous,
                    options.trace,
                    observer(hooks),
                    threads,
                    options.checkpoints.store.empty() ? nullptr : &checkpoint,
                    record);
        };
        try {
          run();
        } catch (const StageLeft&) {
          throw;
        } catch (...) {
          // A state that leads nowhere would do so every time.
          if (!checkpoint.restored()) throw;
          checkpoint.drop();
          record = blank(c, position, options.revision);
          run();
        }
        record.run.thread_changes =
            changes_text(checkpoint.threads(),
                         options.threads > 0 ? options.threads : count);
        record.crowded = options.crowded ||
                         !record.run.thread_changes.empty() ||
                         shared_its_core(record.clocks.solve);
        record.finished = utc_now();
      } catch (const StageLeft&) {
        throw;
      } catch (...) {
        const StageRecord until = std::move(record);
        record = lost_stage(
            c, position, Stop::failed, exception_text(), options.revision);
        record.clocks = until.clocks, record.counts = until.counts;
        failed = record.stage;
      }
    }
    if (hooks.finished) hooks.finished(record);
    const bool goes_on = failed.empty() && position + 1 < stages;
    if (goes_on && options.checkpoints.asked() != Leaving::no)
      throw StageLeft();
  }
}

}  // namespace physinv
