#include "suite/evidence/curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "suite/core/math.h"
#include "suite/evidence/statistics.h"

namespace physinv {
namespace {

/// Shares as weights: what lies behind an infinite loss is infinite.
LossPoint between(const LossPoint& a, const LossPoint& b, double share) {
  const auto mix = [&](double u, double v) {
    return (1 - share) * u + share * v;
  };
  return {mix(a.updates, b.updates),
          mix(a.seconds, b.seconds),
          math::exp(mix(math::log(a.loss), math::log(b.loss)))};
}

/// Where updates or seconds reach `x`.
std::optional<LossPoint> where(double LossPoint::*axis,
                               double x,
                               const StageRecord& stage) {
  for (Index k = 0; k < stage.curve.points(); ++k) {
    const LossPoint next = loss_point(stage, k);
    if (next.*axis < x) continue;
    if (k == 0 || next.*axis == x) return next;
    const LossPoint before = loss_point(stage, k - 1);
    return between(
        before, next, (x - before.*axis) / (next.*axis - before.*axis));
  }
  return {};
}

}  // namespace

double CurveRow::operator()(Index k) const {
  const double value = stage.arrays.at(array)(row, k);
  return value < std::numeric_limits<double>::max() ? value : kInfinite;
}

std::optional<Index> last_point(const StageRecord& stage, Index updates) {
  const auto& iteration = stage.curve.iteration;
  const auto last = static_cast<double>(updates);
  if (iteration.back() < last) return {};
  const auto after = std::upper_bound(iteration.begin(), iteration.end(), last);
  return static_cast<Index>(after - iteration.begin()) - 1;
}

LossPoint loss_point(const StageRecord& stage, Index k) {
  const CurveRow loss{stage};
  return {loss.updates(k),
          stage.curve.seconds[static_cast<std::size_t>(k)],
          loss(k)};
}

std::optional<LossPoint> level_at(const StageRecord* stage, double updates) {
  if (stage == nullptr) return {};
  if (const auto level = where(&LossPoint::updates, updates, *stage))
    return level;
  if (stage->stop == Stop::diverged) return LossPoint{updates, 0, kInfinite};
  return {};
}

std::optional<double> loss_at(const StageRecord& stage, double updates) {
  const auto level = level_at(&stage, updates);
  if (!level) return {};
  return level->loss;
}

std::optional<LossPoint> level_after(const StageRecord& stage, double seconds) {
  return where(&LossPoint::seconds, seconds, stage);
}

std::optional<LossPoint> reaches(const StageRecord* stage, double loss) {
  if (stage == nullptr) return {};
  for (Index k = 0; k < stage->curve.points(); ++k) {
    const LossPoint next = loss_point(*stage, k);
    if (next.loss > loss) continue;
    if (k == 0) return next;
    const LossPoint before = loss_point(*stage, k - 1);
    return between(
        before,
        next,
        math::log(before.loss / loss) / math::log(before.loss / next.loss));
  }
  return {};
}

}  // namespace physinv
