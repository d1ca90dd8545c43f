#include "suite/cases/jpo/common/shares.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "suite/core/check.h"

namespace physinv {
namespace {

bool are_equal(double a, double b, Equality equality) {
  if (equality == Equality::strict || !std::isfinite(b)) return a == b;
  const double wide = equality == Equality::band ? 1e-3 : 1e-6;
  return std::abs(a - b) <= wide * std::abs(b);
}

}  // namespace

Shares compare_losses(VectorIn<double> loss,
                      VectorIn<double> bfgs,
                      Equality equality) {
  SUITE_CHECK(loss.size() == bfgs.size() && loss.size() > 0,
              "losses of the same problems");
  Index better = 0, equal = 0;
  for (Index i = 0; i < loss.size(); ++i) {
    if (!std::isfinite(loss[i])) continue;
    if (are_equal(loss[i], bfgs[i], equality)) {
      ++equal;
    } else if (!(loss[i] >= bfgs[i])) {  // also where BFGS has NaN
      ++better;
    }
  }
  const auto count = static_cast<double>(loss.size());
  return {static_cast<double>(better) / count,
          static_cast<double>(equal) / count,
          static_cast<double>(loss.size() - better - equal) / count};
}

std::optional<double> decrease_share(VectorIn<double> start,
                                     VectorIn<double> fit,
                                     VectorIn<double> refined) {
  double sum = 0;
  Index count = 0;
  for (Index i = 0; i < fit.size(); ++i) {
    const double end =
        std::isfinite(refined(i)) ? std::min(fit(i), refined(i)) : fit(i);
    const double share = (start(i) - fit(i)) / (start(i) - end);
    if (!std::isfinite(share)) continue;  // no decrease, or no number
    sum += share;
    ++count;
  }
  if (count == 0) return {};
  return sum / static_cast<double>(count);
}

Solved::Solved(double loss)
    : Solved(
          [loss](const CaseData&, const StageRecord& stage, Index example) {
            return stage.loss[example] < loss;
          },
          fmt::format("loss < {:g}", loss)) {}

Index Solved::count(const CaseData& data, const StageRecord& stage) const {
  Index count = 0;
  for (Index i = 0; i < stage.loss.size(); ++i) count += test_(data, stage, i);
  return count;
}

Solved within_of_truth(double tolerance) {
  return {[tolerance](
              const CaseData& data, const StageRecord& stage, Index example) {
            return ((stage.x.col(example) - data.x.col(example)).array().abs() <
                    tolerance)
                .all();
          },
          fmt::format("every unknown within {:g} of the truth", tolerance)};
}

}  // namespace physinv
