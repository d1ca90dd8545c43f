#include "suite/compare/reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "suite/evidence/convergence_history.h"
#include "suite/evidence/statistics.h"
#include "suite/results/crowded.h"
#include "suite/results/loss_summary.h"
#include "suite/store/case_file.h"
#include "suite/store/repetitions.h"

namespace physinv {
namespace {

double or_infinite(double value) {
  return std::isfinite(value) ? value : kInfinite;
}

Quartiles solving_quartiles(const StageRecord& s, double Seconds::*clock) {
  std::vector<double> seconds = solving_times(s, clock);
  for (double& value : seconds) value = or_infinite(value);
  return quartiles_of(seconds);
}

std::optional<Times> times_of(const StageRecord& s) {
  if (!has_time(s)) return {};
  return Times{solving_quartiles(s, &Seconds::wall),
               solving_quartiles(s, &Seconds::cpu),
               s.run.threads,
               s.crowded};
}

/// Of all stages' medians.
template <class F>
Quartiles quartiles_over(const std::vector<const Reading*>& stages,
                         F&& number) {
  std::vector<double> values;
  for (const Reading* r : stages) values.push_back(number(*r));
  return quartiles_of(values);
}

std::optional<Times> times_of(std::vector<const Reading*> stages) {
  std::erase_if(stages, [](const Reading* r) { return !r->times; });
  if (stages.empty()) return {};
  Times times{
      quartiles_over(stages,
                     [](const Reading& r) { return r.times->wall.median; }),
      quartiles_over(stages,
                     [](const Reading& r) { return r.times->cpu.median; })};
  for (const Reading* r : stages) {
    if (r->times->threads != 1) times.threads = r->times->threads;
    times.crowded = times.crowded || r->times->crowded;
  }
  return times;
}

Stop end_of(const Reading& stage) { return stage.ends.begin()->first; }

bool is_known(const Quartiles& seconds) {
  return std::isfinite(seconds.median);
}

}  // namespace

Quartiles quartiles_of(const std::vector<double>& values) {
  return {quantile(values, 0.25),
          median(values),
          quantile(values, 0.75),
          values.size()};
}

bool Times::of_one_core() const {
  return threads == 1 ||
         (threads == 0 && cpu.median <= wall.median + kClockResolution);
}

double Reading::simulations() const { return simulations_of(counts); }

double Reading::passes() const {
  return static_cast<double>(counts[Counter::network_forward] +
                             counts[Counter::network_backward]);
}

Reading reading_of(const StageRecord& s,
                   const StageRecord* first,
                   const Thresholds& thresholds) {
  std::vector<double> losses;
  for (const double loss : s.loss) losses.push_back(or_infinite(loss));
  Reading r{
      .stages = 1,
      .ends = {{s.stop, 1}},
      .statuses = count(s.status),
      .nonfinite = std::count(losses.begin(), losses.end(), kInfinite),
      .solved =
          std::count_if(losses.begin(),
                        losses.end(),
                        [&](double loss) { return loss <= thresholds.solved; }),
      .examples = s.arrays.contains(kLossSummary)
                      ? 0
                      : static_cast<Index>(losses.size()),
      .position = s.position,
      .message = s.message,
      .loss = quartiles_of(losses.empty() ? std::vector{kInfinite} : losses),
      .times = times_of(s),
      .iterations = s.iterations,
      .counts = s.counts};
  if (first != nullptr && has_result(s) &&
      results_hash(s) == results_hash(*first))
    r.same_bits = 1;
  return r;
}

Reading reading_of(const std::vector<const Reading*>& stages) {
  Reading sum;
  for (const Reading* r : stages) {
    sum.stages += r->stages;
    sum.same_bits += r->same_bits;
    for (const auto& [end, count] : r->ends) sum.ends[end] += count;
    for (std::size_t i = 0; i < sum.statuses.size(); ++i)
      sum.statuses[i] += r->statuses[i];
    sum.nonfinite += r->nonfinite;
    sum.solved += r->solved;
    sum.examples += r->examples;
    sum.iterations += r->iterations;
    sum.counts += r->counts;
  }
  sum.loss =
      quartiles_over(stages, [](const Reading& r) { return r.loss.median; });
  sum.times = times_of(stages);
  return sum;
}

Direction end_direction(const Reading& a, const Reading& b) {
  const Direction stage = direction(end_of(a), end_of(b));
  if (stage != Direction::same) return stage;
  const Direction examples = direction(a.statuses, b.statuses);
  return b.nonfinite > a.nonfinite      ? Direction::worse
         : examples == Direction::worse ? Direction::worse
         : b.nonfinite < a.nonfinite    ? Direction::better
                                        : examples;
}

std::string end_text(const Reading& a, const Reading& b) {
  if (end_of(a) != end_of(b))
    return fmt::format("{} -> {}{}{}",
                       to_string(end_of(a)),
                       to_string(end_of(b)),
                       b.message.empty() ? "" : ": ",
                       b.message);
  if (a.statuses != b.statuses)
    return status_text(a.statuses) + " -> " + status_text(b.statuses);
  if (a.nonfinite != b.nonfinite)
    return fmt::format(
        "losses that are not finite {} -> {}", a.nonfinite, b.nonfinite);
  return "";
}

double loss_ratio(const Reading& a, const Reading& b) {
  if (std::isinf(a.loss.median) && std::isinf(b.loss.median)) return 1;
  return std::max(b.loss.median, kEqualLoss) /
         std::max(a.loss.median, kEqualLoss);
}

bool costs_compare(const Reading& a, const Reading& b) {
  return a.times && b.times && a.nonfinite == b.nonfinite;
}

TimeRatio time_ratio(const Reading& a, const Reading& b) {
  TimeRatio ratio;
  for (const Reading* r : {&a, &b})
    if (!r->times) ratio.why = to_string(end_of(*r));
  if (!ratio.why.empty()) return ratio;
  const bool alone = a.times->of_one_core() && b.times->of_one_core();
  ratio.a = alone ? a.times->cpu : a.times->wall;
  ratio.b = alone ? b.times->cpu : b.times->wall;
  if (!costs_compare(a, b)) {
    ratio.why = "other losses not finite";
  } else if (!alone && (a.times->crowded || b.times->crowded)) {
    ratio.why = "crowded";
  } else if (!is_known(ratio.a) || !is_known(ratio.b)) {
    ratio.a_unknown = !is_known(ratio.a);
    ratio.b_unknown = !is_known(ratio.b);
    ratio.why = "not known";
  } else {
    ratio.compares = true;
    if (ratio.a.median > 0)
      ratio.value = ratio.b.median / ratio.a.median;
    else
      ratio.why = "0 s";
  }
  return ratio;
}

std::optional<double> raised_ratio(const TimeRatio& t) {
  if (!t.compares) return {};
  return std::max(t.b.median, kShortTime) / std::max(t.a.median, kShortTime);
}

bool is_slower(const TimeRatio& t, double factor) {
  return t.compares && std::max(t.b.low, kShortTime) >
                           factor * std::max(t.a.high, kShortTime);
}

}  // namespace physinv
