// What claims.md uses and formulas cannot express.
#include "suite/cases/common/claims.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "suite/cases/hig/toy/toy.h"
#include "suite/core/math.h"
#include "suite/evidence/curve_shape.h"
#include "suite/store/record.h"

namespace physinv::toy {
namespace {

/// What the second component has lost of its loss once the first one's is down
/// to a third; empty if it never is.
std::optional<double> second_lost(const Run& run) {
  const CurveRow first{*run.stage, "metrics", kFirstLoss},
      second{*run.stage, "metrics", kSecondLoss};
  for (Index k = 0; k < first.points(); ++k)
    if (first(k) <= first(0) / 3) return 1 - second(k) / second(0);
  return {};
}

/// Distance over length of the point's path in the last half of the updates.
std::optional<double> straightness(const Run& run) {
  const CurveRow x{*run.stage, "metrics", kPathFirst},
      y{*run.stage, "metrics", kPathSecond};
  const Index last = x.points() - 1;
  Index from = 0;
  while (x.updates(from) < x.updates(last) / 2) ++from;
  double path = 0;
  for (Index k = from; k < last; ++k)
    path += math::hypot(x(k + 1) - x(k), y(k + 1) - y(k));
  if (!(path > 0)) return {};
  return math::hypot(x(last) - x(from), y(last) - y(from)) / path;
}

/// The largest median along the curves.
Quantity highest_median(const Select& method) {
  return highest_along(
      method, 0, [=](double updates) { return median_after(method, updates); });
}

Quantity most_diverged() {
  std::vector<Quantity> counts;
  for (const char* method : {"adam", "gn", "hig", "sgd", "gn_tau6"})
    counts.push_back(
        count({method}, diverged(), [](double v) { return v > 0; }));
  return most(counts);
}

/// Of shares, by the deviations of the seeds' own.
Quantity errors_apart(const Select& a, const Select& b) {
  const Quantity x = share_of_examples(a, last_deviations, is_saturated),
                 y = share_of_examples(b, last_deviations, is_saturated);
  return {[=](const Evidence& e) {
            const Measured u = x(e), v = y(e);
            if (!u.value || !v.value) return u.value ? v : u;
            const double error =
                math::hypot(u.spread.value_or(0), v.spread.value_or(0)) /
                std::sqrt(static_cast<double>(std::min(u.runs, v.runs)));
            return Measured{.value = (*u.value - *v.value) / error,
                            .runs = std::min(u.runs, v.runs)};
          },
          {a, b}};
}
}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("second_loss", metric(kSecondLoss));
  names.set("second_lost", second_lost);
  names.set("straightness", straightness);
  names.set("last_deviations", last_deviations);
  names.set("is_saturated", std::function<bool(double)>(is_saturated));
  names.set("saturated_neurons", saturated_neurons());
  names.add("highest_median", highest_median);
  names.add("most_diverged", most_diverged);
  names.add("errors_apart", errors_apart);
  add_claims_of_folder(r, "hig/toy", names);
}

}  // namespace physinv::toy
