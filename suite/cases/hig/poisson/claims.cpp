// What claims.md uses and formulas cannot express.
#include "suite/cases/common/claims.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "suite/cases/hig/poisson/quantities.h"
#include "suite/core/power_of_ten.h"
#include "suite/evidence/curve_shape.h"
#include "suite/evidence/training.h"

namespace physinv::hig::poisson {
namespace {

Clock paper() {
  return paper_seconds([](const Run& run) {
    const bool hig = run.stage->stage == "hig";
    return std::string(hig ? "table4/hig/b=64/update"
                           : "table4/adam/b=64/update");
  });
}

/// Start over lowest loss; of a run with fewer updates only if that is enough.
RunValue fall_by(double factor, double updates) {
  return [=](const Run& run) -> std::optional<double> {
    const RunValue fall = over(first_loss(), lowest_loss());
    const auto found = fall(run);
    return found && *found >= factor ? found : if_ran(updates, fall)(run);
  };
}

/// f of the medians over seeds after 0, 1, ... updates.
auto of_medians(double (*f)(const std::vector<double>&)) {
  return [=](const Select& select, int updates) -> Quantity {
    return {[=](const Evidence& e) {
              std::vector<double> curve;
              Measured m;
              for (int k = 0; k <= updates; ++k) {
                m = median_after(select, k)(e);
                if (!m.value) return m;
                curve.push_back(*m.value);
              }
              m.value = f(curve);
              return m;
            },
            {select}};
  };
}

double lowest_share(const std::vector<double>& losses) {
  return *std::min_element(losses.begin(), losses.end()) / losses.front();
}

std::vector<double> falls(const std::vector<double>& losses) {
  std::vector<double> all;
  for (std::size_t k = 1; k < losses.size(); ++k)
    all.push_back(1 - losses[k] / losses[k - 1]);
  return all;
}
double least_fall(const std::vector<double>& losses) {
  const auto all = falls(losses);
  return *std::min_element(all.begin(), all.end());
}
double largest_fall(const std::vector<double>& losses) {
  const auto all = falls(losses);
  return *std::max_element(all.begin(), all.end());
}

/// Of the updates from weights that Adam has trained for 30000 updates, or of
/// all others.
Quantity of_phases(double (*f)(const std::vector<Phase>&), bool late = false) {
  return {[=](const Evidence& e) {
            auto all = phases(e);
            std::erase_if(all, [=](const Phase& p) {
              return p.method.starts_with("long-adam") != late;
            });
            if (all.empty()) return missing("an update by HIG or GN");
            const double value = f(all);
            if (!std::isfinite(value)) return missing("a known smallest one");
            return Measured{.value = value};
          },
          late ? std::vector<Select>{{"long-adam-hig", "hig"}}
               : std::vector<Select>{{"hig-b4"}, {"gn-b4"}}};
}
double most_dropped(const std::vector<Phase>& all) {
  Index dropped = 0;
  for (const Phase& p : all) dropped = std::max(dropped, p.rows - p.least_kept);
  return static_cast<double>(dropped);
}
double smallest_seen(const std::vector<Phase>& all) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Phase& p : all) smallest = std::min(smallest, p.smallest);
  return smallest;
}

std::optional<double> megabytes(const Run& run) {
  return 1e-6 * static_cast<double>(run.stage->buffer_bytes);
}

/// Decided only if HIG took off a tenth: else there is nothing to lose.
Quantity if_it_dropped(const Quantity& a) {
  const Quantity lowest_over_start =
      median({"long-adam-hig-adam", "hig"}, over(lowest_loss(), first_loss()));
  return {[=](const Evidence& e) {
            const Measured drop = lowest_over_start(e);
            if (!drop.value) return drop;
            return *drop.value <= 0.9 ? a(e) : missing("HIG gained nothing");
          },
          a.runs()};
}

/// Adam after HIG: the highest loss of the first tenth of HIG's time, at least
/// 200 updates.
constexpr double kReturn = 2509;
std::optional<double> highest_of_return(const Run& run) {
  double highest = 0;
  for (double u = 200; u <= kReturn; u *= 1.1) {
    const auto loss = loss_at(*run.stage, u);
    if (!loss) return {};
    highest = std::max(highest, *loss);
  }
  return highest;
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  // Half an order less than three: read from a plot.
  names.set("three_orders", math::power_of_ten(2.5));
  names.set("paper", paper());
  names.add("fall_by", fall_by);
  names.add("lowest_share", of_medians(lowest_share));
  names.add("least_fall", of_medians(least_fall));
  names.add("largest_fall", of_medians(largest_fall));
  names.add("most_dropped", [] { return of_phases(most_dropped); });
  names.add("most_dropped_late", [] { return of_phases(most_dropped, true); });
  names.add("smallest_seen", [] { return of_phases(smallest_seen); });
  names.add("smallest_seen_late",
            [] { return of_phases(smallest_seen, true); });
  names.set("megabytes", megabytes);
  names.add("if_it_dropped", if_it_dropped);
  names.set("return_updates", kReturn);
  names.set("highest_of_return", highest_of_return);
  add_claims_of_folder(r, "hig/poisson", names);
}

}  // namespace physinv::hig::poisson
