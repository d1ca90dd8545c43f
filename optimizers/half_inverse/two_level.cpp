#include "optimizers/half_inverse/two_level.h"

#include <algorithm>
#include <limits>

#include "suite/core/eigen_caches.h"

namespace physinv::hig {
namespace {

/// Ranges around the cut, tried in this order: cut / width ... cut width.
constexpr double kWidths[] = {1.25, 1.6, 2, 2.5, 3.2, 4, 5, 6.4, 8, 16, 64};
constexpr double kSecondLevel = 1e-4;  ///< of s_max, where those do not do
/// Part of the tolerance that a range may be expected to need: refined values
/// may lie nearer to the cut.
constexpr double kExpected = 0.8;

}  // namespace

/// The first level's spectrum with the values in [low, high] at the end.
void TwoLevelPower::arrange(double low, double high) {
  const Spectrum& first = first_.spectrum();
  const Index m = first.lambda.size();
  const auto inside = [&](Index i) {
    const double s = first.s(i);
    return low <= s && s <= high;
  };
  order_.clear();
  for (Index i = 0; i < m; ++i)
    if (!inside(i)) order_.push_back(i);
  inside_ = m - static_cast<Index>(order_.size());
  for (Index i = 0; i < m; ++i)
    if (inside(i)) order_.push_back(i);
  spectrum_.lambda = first.lambda(order_);
  spectrum_.c = first.c(order_);
  spectrum_.scale = first.scale;
  spectrum_.noise = first.noise;
  spectrum_.noise.tail_begin = m - inside_;
  set_inside(spectrum_.lambda.tail(inside_));
}

void TwoLevelPower::set_inside(VectorIn<double> values) {
  if (inside_ == 0) return;
  spectrum_.lambda.tail(inside_) = values;
  spectrum_.noise.tail = spectrum_.noise.slope *
                         std::max(values.maxCoeff(), 0.0) /
                         spectrum_.lambda.maxCoeff();
}

/// The spectrum of W2^T W2 for the range.
Ending TwoLevelPower::refine(Index parameters, const Pullback& pullback) {
  const std::vector<Index> wanted(order_.end() - inside_, order_.end());
  if (wanted == refined_) return second_.ending();
  refined_ = wanted;
  ++made_;
  state_caches();
  Batch<double> u2(spectrum_.lambda.size(), inside_), w2(parameters, inside_);
  first_.directions(wanted, u2);
  pullback(u2, w2);
  Batch<double> square = Batch<double>::Zero(inside_, inside_);
  square.selfadjointView<Eigen::Lower>().rankUpdate(w2.transpose());
  // The spectrum is wanted even where g has no part in it.
  Vector<double> c = spectrum_.c.tail(inside_);
  if (c.isZero(0)) c(0) = std::numeric_limits<double>::min();
  return second_.factor(square, c);
}

/// The update from the range as it is arranged; v stays zero where its error
/// exceeds `most`.
PowerReport TwoLevelPower::settle(const Power& power,
                                  double most,
                                  Index parameters,
                                  const Pullback& pullback,
                                  VectorOut<double> v) {
  const Ending ending =
      inside_ > 0 ? refine(parameters, pullback) : Ending::zero;
  const bool turned = ending == Ending::ok;
  if (turned) {
    const Spectrum& second = second_.spectrum();
    const double rescale = second.scale / spectrum_.scale;
    set_inside(second.lambda * (rescale * rescale));
    spectrum_.c.tail(inside_) = second.c;
  } else if (ending == Ending::zero) {  // W2 = 0
    set_inside(Vector<double>::Zero(inside_));
  } else {
    return {.ending = ending};
  }
  const PowerReport report = power_weights(spectrum_, power, weights_);
  if (report.kept == 0 || report.error > most) return report;
  if (turned) second_.leave_eigenbasis(weights_.tail(inside_));
  v(order_) = weights_;
  first_.leave_eigenbasis(v);
  return report;
}

PowerReport TwoLevelPower::apply(const Power& power,
                                 double tolerance,
                                 Index parameters,
                                 const Pullback& pullback,
                                 VectorOut<double> v) {
  v.setZero();
  made_ = 0;
  if (first_.ending() != Ending::ok) return {.ending = first_.ending()};
  weights_.resize(v.size());
  const double s_max = first_.spectrum().s_max();
  const double cut = power.cut(s_max);
  for (const double width : kWidths) {
    arrange(cut / width, cut * width);
    if (!proven(power_weights(spectrum_, power, weights_),
                kExpected * tolerance))
      continue;
    const PowerReport report =
        settle(power, tolerance, parameters, pullback, v);
    if (proven(report, tolerance)) return report;
    v.setZero();
  }
  arrange(0, kSecondLevel * s_max);
  const double any = std::numeric_limits<double>::infinity();
  return settle(power, any, parameters, pullback, v);
}

}  // namespace physinv::hig
