// What claims.md uses and formulas cannot express.
#include "suite/cases/common/claims.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "suite/cases/physgrad/scaling/quantities.h"
#include "suite/cases/physgrad/scaling/scaling.h"
#include "suite/core/math.h"

namespace physinv::scaling {
namespace {

using OfPath = std::function<double(const Path&)>;

Quantity of(const Select& method, const OfPath& value, Index problem) {
  return median(method, [=](const Run& run) -> std::optional<double> {
    if (problem >= Path::count(*run.stage)) return {};
    return value(Path(*run.stage, problem));
  });
}

// ---- y = (x1, alpha x2) -----------------------------------------------------

/// Degrees between the first update and the way to the minimum.
double angle(const Path& p) {
  const Vector<double> u = p.x().col(0) - p.x().col(1), x = p.x().col(0);
  return math::atan2(std::abs(u(0) * x(1) - u(1) * x(0)), u.dot(x)) * 180 /
         std::numbers::pi;
}
double first_step(const Path& p) { return p.x()(1, 1) - p.x()(1, 0); }
/// x2 / x1 after a step over that of the start.
double ratio_kept(const Path& p) {
  return p.x()(1, 1) / p.x()(0, 1) / (p.x()(1, 0) / p.x()(0, 0));
}
/// Of |x2| in the last step, and of the slowest step along x1.
double growth(const Path& p) {
  return std::abs(p.x()(1, p.steps()) / p.x()(1, p.steps() - 1));
}
double left_of_x1(const Path& p) {
  const auto x1 = p.x().row(0);
  return (x1.tail(p.steps()).array() / x1.head(p.steps()).array()).minCoeff();
}
/// Steps until 1 % of a coordinate is left.
OfPath steps_to_a_percent(Index row) {
  return [row](const Path& p) {
    Index k = 0;
    while (k < p.steps() &&
           std::abs(p.x()(row, k)) > 0.01 * std::abs(p.x()(row, 0)))
      ++k;
    return static_cast<double>(k);
  };
}
/// Largest of | |dx| / |x| - rate |.
double off_the_rate(const Path& p) {
  double worst = 0;
  for (Index k = 0; k < p.steps(); ++k) {
    const double step = (p.x().col(k + 1) - p.x().col(k)).norm();
    worst = std::max(worst, std::abs(step / p.x().col(k).norm() - kRate));
  }
  return worst;
}
/// Largest relative distance of any scale's trajectory from that of scale 1.
Quantity apart(const Select& method) {
  return median(method, [](const Run& run) -> std::optional<double> {
    const Index problems = Path::count(*run.stage);
    if (problems < 2) return {};
    const Batch<double> one = Path(*run.stage).x();
    double worst = 0;
    for (Index i = 1; i < problems; ++i)
      worst = std::max(worst,
                       ((Path(*run.stage, i).x() - one).array() / one.array())
                           .abs()
                           .maxCoeff());
    return worst;
  });
}

// ---- y = (x1, x2^2) ---------------------------------------------------------

OfPath end(Index row) {
  return [row](const Path& p) { return p.x()(row, p.steps()); };
}
double distance(const Path& p) { return p.distance(); }
double diagonal(const Path& p) { return p.diagonal(); }
double off_the_line(const Path& p) {
  const Batch<double> y = p.squared();
  return (y.row(1) - 3 * y.row(0)).cwiseAbs().maxCoeff();
}
/// Of the last step along x2 over the first, each over its x2.
double relative_step_kept(const Path& p) {
  const auto step = [&](Index k) { return 1 - p.x()(1, k + 1) / p.x()(1, k); };
  return step(p.steps() - 1) / step(0);
}
/// Largest |P(x + dx) - (y + dy)| / |y| with dy = -rate y.
double missed(const Path& p) {
  const Batch<double> y = p.squared();
  double worst = 0;
  for (Index k = 0; k < p.steps(); ++k)
    worst = std::max(
        worst,
        (y.col(k + 1) - (1 - kRate) * y.col(k)).norm() / y.col(k).norm());
  return worst;
}
/// Mean distance of all coordinates from those of PG.
Quantity mean_apart(const Select& method) {
  const auto value = [](const Run& run) -> std::optional<double> {
    const auto other = run.beside({"pg"});
    if (!other) return {};
    return (Path(*run.stage).x() - Path(*other->stage).x()).cwiseAbs().mean();
  };
  return depends_on(median(method, value), {{"pg"}});
}
void add_paths(ClaimNames& names) {
  // Places of the scales 1, 3, 5 among the problems.
  names.set("alpha_3", 1);
  names.set("alpha_5", 2);
  names.add("of", of);
  names.add("of", [](const Select& method, const OfPath& value) {
    return of(method, value, 0);
  });
  names.add("apart", apart);
  names.add("mean_apart", mean_apart);
  const std::pair<const char*, OfPath> paths[] = {
      {"angle", angle},
      {"first_step", first_step},
      {"ratio_kept", ratio_kept},
      {"growth", growth},
      {"left_of_x1", left_of_x1},
      {"off_the_rate", off_the_rate},
      {"distance", distance},
      {"diagonal", diagonal},
      {"off_the_line", off_the_line},
      {"relative_step_kept", relative_step_kept},
      {"missed", missed},
      {"steps_to_a_percent_of_x1", steps_to_a_percent(0)},
      {"steps_to_a_percent_of_x2", steps_to_a_percent(1)},
      {"end_x1", end(0)},
      {"end_x2", end(1)}};
  for (const auto& [name, value] : paths) names.set(name, value);
}

/// Of single steps, from the arrays of the stage `identities`.
void add_identities(ClaimNames& names) {
  names.add("identity", identity);
  const std::pair<const char*, OfArray> numbers[] = {
      {"slope", slope},
      {"gd_off", gd_off},
      {"ig_off", ig_off},
      {"off_the_mean", off_the_mean},
      {"off_the_start", off_the_start},
      {"quotients_lost", quotients_lost},
      {"steps_lost", steps_lost},
      {"reversal_end", reversal_end},
      {"reversal_order", reversal_order},
      {"root_off", root_off},
      {"wrong_branch", wrong_branch},
      {"off_near", inverse_off(true)},
      {"off_beyond", inverse_off(false)},
      {"spread_of_ig", spread_of_row(0)},
      {"spread_of_newton", spread_of_row(1)},
      {"spread_of_gd", spread_of_row(2)},
      {"small_share_of_gd", share_at_small(1)},
      {"small_share_of_ig", share_at_small(2)}};
  for (const auto& [name, value] : numbers) names.set(name, value);
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  add_paths(names);
  add_identities(names);
  add_claims_of_folder(r, "physgrad/scaling", names);
}

}  // namespace physinv::scaling
