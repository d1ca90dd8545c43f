#include "suite/evidence/training.h"

#include <algorithm>
#include <utility>

#include "suite/evidence/run_values.h"
#include "suite/evidence/statistics.h"
#include "suite/results/crowded.h"

namespace physinv {
namespace {

/// f(row of the curve) of runs that have one.
template <class F>
RunValue of_curve(RowOfCurve which, F f) {
  return [=](const Run& run) -> std::optional<double> {
    if (!run.stage->arrays.contains(which.array) ||
        run.stage->curve.points() == 0)
      return {};
    return f(CurveRow{*run.stage, which.array, which.row});
  };
}

/// Of all points, the one that is `better` than those before.
RunValue best_of(RowOfCurve which, bool (*better)(double, double)) {
  return of_curve(which, [=](const CurveRow& row) {
    double found = row(0);
    for (Index k = 1; k < row.points(); ++k)
      if (better(row(k), found)) found = row(k);
    return found;
  });
}

bool has_loss(const Run& run) {
  return run.stage->arrays.contains("mean_loss") &&
         run.stage->curve.points() > 0;
}

}  // namespace

Clock updates() {
  return {[](const Run& run, double t) { return level_at(run.stage, t); },
          [](const Run&, const LossPoint& p) { return p.updates; }};
}

Clock own_seconds() {
  return {[](const Run& run, double t) { return level_after(*run.stage, t); },
          [](const Run&, const LossPoint& p) { return p.seconds; }};
}

Clock paper_seconds(std::function<std::string(const Run&)> update) {
  const auto seconds = [=](const Run& run) -> std::optional<double> {
    const auto found = find_printed(
        run.evidence->published, run.record->info.experiment, update(run));
    return found ? std::optional(found->value) : std::nullopt;
  };
  return {[=](const Run& run, double t) -> std::optional<LossPoint> {
            const auto each = seconds(run);
            if (!each) return {};
            return level_at(run.stage, t / *each);
          },
          [=](const Run& run, const LossPoint& p) -> std::optional<double> {
            const auto each = seconds(run);
            if (!each) return {};
            return p.updates * *each;
          }};
}

RunValue loss_at(Clock clock, double time) {
  return [=](const Run& run) -> std::optional<double> {
    if (!has_loss(run)) return {};
    const auto found = clock.at(run, time);
    return found ? std::optional(found->loss) : std::nullopt;
  };
}

RunValue loss_after(double count) { return loss_at(updates(), count); }

Quantity median_after(Select select, double updates) {
  return median(std::move(select), loss_after(updates));
}
Quantity median_at_end(Select select) {
  return median(std::move(select), last_loss());
}
Quantity lowest_at_end(Select select) {
  return lowest(std::move(select), last_loss());
}

RunValue loss_at_share(double share) {
  return of_curve({}, [=](const CurveRow& row) {
    return loss_at(row.stage, share * row.updates(row.points() - 1));
  });
}

RunValue last_loss() {
  return of_curve({}, [](const CurveRow& row) {
    return row.stage.stop == Stop::diverged ? kInfinite : row.last();
  });
}

RunValue time_to(Clock clock, double level) {
  return time_to(std::move(clock),
                 [=](const Run&) { return std::optional(level); });
}

RunValue time_to(Clock clock, RunValue level) {
  return [=](const Run& run) -> std::optional<double> {
    const auto loss = level(run);
    if (!loss || !has_loss(run)) return {};
    const auto found = reaches(run.stage, *loss);
    if (!found) return kInfinite;
    return clock.time(run, *found);
  };
}

RunValue length(Clock clock) {
  return [=](const Run& run) -> std::optional<double> {
    if (!has_loss(run)) return {};
    return clock.time(run,
                      loss_point(*run.stage, run.stage->curve.points() - 1));
  };
}

RunValue first_below(double level, RowOfCurve which) {
  return of_curve(which, [=](const CurveRow& row) {
    for (Index k = 0; k < row.points(); ++k)
      if (row(k) < level) return row.updates(k);
    return kInfinite;
  });
}

RunValue first_of(RowOfCurve which) {
  return of_curve(which, [](const CurveRow& row) { return row(0); });
}
RunValue last_of(RowOfCurve which) {
  return of_curve(which, [](const CurveRow& row) { return row.last(); });
}

RunValue value_after(RowOfCurve which, Index count) {
  return of_curve(which, [=](const CurveRow& row) -> std::optional<double> {
    const auto k = last_point(row.stage, count);
    return k ? std::optional(row(*k)) : std::nullopt;
  });
}

RunValue lowest_of(RowOfCurve which) {
  return best_of(which, [](double a, double b) { return a < b; });
}
RunValue highest_of(RowOfCurve which) {
  return best_of(which, [](double a, double b) { return a > b; });
}

RunValue largest_rise(RowOfCurve which) {
  return of_curve(which, [](const CurveRow& row) {
    double lowest = row(0), most = 0;
    for (Index k = 0; k < row.points(); ++k) {
      most = std::max(most, row(k) / lowest);
      lowest = std::min(lowest, row(k));
    }
    return most;
  });
}

RunValue share_left(RowOfCurve row) {
  return over(last_of(row), first_of(row));
}

RunValue late_training_error() {
  return of_array("late_error",
                  [](const Batch<double>& error) { return error(0, 0); });
}

RunValue diverged() {
  return [](const Run& run) {
    return std::optional(run.stage->stop == Stop::diverged ? 1.0 : 0.0);
  };
}

RunValue seconds_per_update() {
  return [](const Run& run) -> std::optional<double> {
    const auto seconds = seconds_to_tell(*run.stage);
    if (run.stage->iterations == 0 || !seconds || is_crowded(*run.stage))
      return {};
    return *seconds / static_cast<double>(run.stage->iterations);
  };
}

RunValue if_ran(double count, RunValue value) {
  return [=](const Run& run) -> std::optional<double> {
    const StageRecord& s = *run.stage;
    const bool whole =
        !s.curve.iteration.empty() && s.curve.iteration.back() >= count;
    if (!whole && s.stop != Stop::diverged) return {};
    return value(run);
  };
}

RunValue or_infinite(RunValue value) {
  return [value = std::move(value)](const Run& run) {
    return run.stage->stop == Stop::diverged ? std::optional(kInfinite)
                                             : value(run);
  };
}

RunValue beside(Select other, RunValue value) {
  return [=](const Run& run) -> std::optional<double> {
    const auto found = run.beside(other);
    return found ? value(*found) : std::nullopt;
  };
}

RunValue over(RunValue a, RunValue b) {
  return [=](const Run& run) -> std::optional<double> {
    const auto x = a(run), y = b(run);
    if (!x || !y) return {};
    return *x / *y;
  };
}

}  // namespace physinv
