#include "optimizers/half_inverse/half_inverse.h"

#include <algorithm>

#include "suite/core/check.h"

namespace physinv::hig {

/// Takes reports_[i] of `path` as the answer, or counts why not.
bool HalfInverse::settled(std::size_t i, Path path, bool last) {
  HalfInverseReport& report = reports_[i];
  report.path = path;
  const bool ended =
      report.ending == Ending::zero || report.ending == Ending::nonfinite;
  report.proven = proven(report, options_.tolerance);
  if (!report.proven && !ended && !last) {
    ++counts_.abandoned[static_cast<std::size_t>(path)];
    ++report.abandoned;
    return false;
  }
  report.spared = report.proven && !ended && !last;
  ++counts_.taken[static_cast<std::size_t>(path)];
  if (!report.proven) ++counts_.unproven;
  done_[i] = true;
  return true;
}

/// Gauss-Newton where nothing is cut.
void HalfInverse::try_shortcut(BatchIn<double> gram,
                               VectorIn<double> g,
                               const Pullback& pullback,
                               std::span<const Power> powers,
                               BatchOut<double> updates) {
  for (std::size_t i = 0; i < powers.size(); ++i) {
    if (powers[i].kappa != -1 || powers[i].beta != 0) continue;
    if (!definite_(gram,
                   g,
                   powers[i],
                   options_.tolerance,
                   v_.col(0),
                   reports_[i],
                   options_.gram_noise)) {
      counts_.abandoned[static_cast<std::size_t>(Path::shortcut)] +=
          definite_.began();
      reports_[i].abandoned += definite_.began();
      continue;
    }
    settled(i, Path::shortcut, false);
    pullback(v_, updates.middleCols(static_cast<Index>(i), 1));
  }
}

/// The settings that are still open by one path: apply(setting, update) ->
/// report, with v_, or the update itself if it is the explicit path, in place.
/// True if none is left.
template <class Apply>
bool HalfInverse::attempt(Path path,
                          bool last,
                          const Pullback& pullback,
                          std::span<const Power> powers,
                          BatchOut<double> updates,
                          Apply&& apply) {
  bool all = true;
  for (std::size_t i = 0; i < powers.size(); ++i) {
    if (done_[i]) continue;
    auto update = updates.col(static_cast<Index>(i));
    static_cast<PowerReport&>(reports_[i]) = apply(powers[i], update);
    if (path == Path::two_level)
      reports_[i].abandoned += two_level_.abandoned();
    if (!settled(i, path, last)) {
      all = false;
    } else if (reports_[i].ending == Ending::zero) {
      update.setZero();
    } else if (reports_[i].ending != Ending::ok) {
      update.setConstant(std::numeric_limits<double>::quiet_NaN());
    } else if (path != Path::explicit_jacobian) {
      pullback(v_, updates.middleCols(static_cast<Index>(i), 1));
    }
  }
  return all;
}

std::span<const HalfInverseReport> HalfInverse::operator()(
    BatchIn<double> gram,
    VectorIn<double> g,
    const Pullback& pullback,
    std::span<const Power> powers,
    BatchOut<double> updates) {
  const Index m = g.size(), p = updates.rows();
  SUITE_CHECK(updates.cols() == static_cast<Index>(powers.size()),
              "there must be one update for each power");
  reports_.assign(powers.size(), {});
  done_.assign(powers.size(), false);
  v_.resize(m, 1);
  if (options_.shortcut) try_shortcut(gram, g, pullback, powers, updates);
  if (std::find(done_.begin(), done_.end(), false) == done_.end())
    return reports_;

  const auto by = [&](Path path, bool last, auto&& apply) {
    return attempt(path, last, pullback, powers, updates, apply);
  };
  spectral_.factor(gram, g, options_.gram_noise);
  if (by(Path::gram, false, [&](const Power& power, auto&) {
        return spectral_.apply(power, v_.col(0), options_.tolerance);
      }))
    return reports_;
  two_level_.open();
  const bool jacobian_fits = m * p <= options_.largest_jacobian;
  if (by(Path::two_level, !jacobian_fits, [&](const Power& power, auto&) {
        return two_level_.apply(
            power, options_.tolerance, p, pullback, v_.col(0));
      }))
    return reports_;
  transposed_.resize(p, m);
  pullback(Batch<double>::Identity(m, m), transposed_);
  explicit_.factor(transposed_.transpose(), g);
  by(Path::explicit_jacobian, true, [&](const Power& power, auto& update) {
    return explicit_.apply(power, update);
  });
  return reports_;
}

}  // namespace physinv::hig
