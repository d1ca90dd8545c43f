#include "suite/cases/jpo/common/shares.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace physinv {

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
