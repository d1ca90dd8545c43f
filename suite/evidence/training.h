/// Numbers of one training run, from the curve of its mean test loss or from
/// another row along it.
///
///   median_after({"hig"}, 320)
///   lowest({"adam"}, loss_at(paper_seconds(update_row), 3240))
///   median({"adam"}, time_to(updates(), beside({"hig"}, loss_after(60))))
#pragma once

#include <functional>
#include <string>

#include "suite/evidence/curve.h"
#include "suite/evidence/quantity.h"

namespace physinv {

/// What time is: updates, the seconds that the stage took, or the seconds it
/// would take if each update were as long as a paper prints.
struct Clock {
  std::function<std::optional<LossPoint>(const Run&, double time)> at;
  std::function<std::optional<double>(const Run&, const LossPoint&)> time;
};
Clock updates();
Clock own_seconds();
/// `update` names the printed seconds of an update: "table3/hig/b=128/update".
Clock paper_seconds(std::function<std::string(const Run&)> update);

/// Test loss at a time, between measured points if need be; infinite behind
/// the end of a run that diverged, empty behind that of another.
RunValue loss_at(Clock clock, double time);
RunValue loss_after(double updates);
/// After this share of the run's updates.
RunValue loss_at_share(double share);
/// At the end of the curve; infinite if the run diverged.
RunValue last_loss();

/// Over all runs.
Quantity median_after(Select select, double updates);
Quantity median_at_end(Select select);
Quantity lowest_at_end(Select select);

/// When the test loss has first fallen to a level; infinite if it never has.
RunValue time_to(Clock clock, double level);
RunValue time_to(Clock clock, RunValue level);
/// How long the run was.
RunValue length(Clock clock);

/// A row of an array along the curve, by default the test loss.
struct RowOfCurve {
  ArrayKey array = kMeanLoss;
  Index row = 0;
};
/// A row of what the experiment records in addition to the loss.
constexpr RowOfCurve metric(Index row) { return {"metrics", row}; }
/// Updates of the first measured point below a level; infinite without one.
RunValue first_below(double level, RowOfCurve row = {});
/// At the first and the last measured point, and at the last one up to so many
/// updates.
RunValue first_of(RowOfCurve row = {});
RunValue last_of(RowOfCurve row = {});
RunValue value_after(RowOfCurve row, Index updates);
/// Of all measured points.
RunValue lowest_of(RowOfCurve row = {});
RunValue highest_of(RowOfCurve row = {});
/// The largest factor by which a point lies above the lowest one up to it.
RunValue largest_rise(RowOfCurve row = {});
/// What is left at the end: last over first point.
RunValue share_left(RowOfCurve row = {});
inline RunValue first_loss() { return first_of(); }
inline RunValue lowest_loss() { return lowest_of(); }
inline RunValue highest_loss() { return highest_of(); }

/// Mean error of the samples seen near the end (a LateError); empty where it
/// was not asked for.
RunValue late_training_error();

/// Whether the run diverged: 1 or 0.
RunValue diverged();
/// CPU time where no more than one core was at work; of stages that had their
/// cores to themselves only.
RunValue seconds_per_update();

/// Of runs of at least so many updates only: in shorter ones fast seeds alone
/// would show. A run that diverged counts as long.
RunValue if_ran(double updates, RunValue value);
/// Of runs that diverged: infinite, whatever they had reached.
RunValue or_infinite(RunValue value);
/// Of the run of another method, or of another stage of the same chain, on the
/// same n and seed.
RunValue beside(Select other, RunValue value);
RunValue over(RunValue a, RunValue b);

}  // namespace physinv
