// The chapter prints no numbers; its notebook prints those of the comparison.
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "suite/cases/physgrad/scaling/quantities.h"
#include "suite/cases/physgrad/scaling/scaling.h"
#include "suite/core/math.h"
#include "suite/harness/registry.h"

namespace physinv::scaling {
namespace {

constexpr double kExact = 1e-13;
/// Places of the scales 1, 3, 5 among the problems.
constexpr Index kOne = 0, kThree = 1, kFive = 2;

using OfPath = std::function<double(const Path&)>;

Quantity of(const char* method, const OfPath& value, Index problem = kOne) {
  return median({method}, [=](const Run& run) -> std::optional<double> {
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
Quantity apart(const char* method) {
  return median({method}, [](const Run& run) -> std::optional<double> {
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

const std::vector<Claim> kScalingClaims(
    {{.id = "P1",
      .where = "Crux of the matter",
      .from = "smoke",
      .says = "For alpha = 1 gradient descent points straight at the minimum, "
              "for larger alpha it does not",
      .conditions = {at_most("degrees, alpha 1", of("gd", angle), 1e-6),
                     above("alpha 3", of("gd", angle, kThree), 1),
                     above("alpha 5", of("gd", angle, kFive), 1)}},
     {.id = "P2",
      .where = "Crux of the matter",
      .from = "smoke",
      .says = "Gradient descent applies the square of the scaling",
      .conditions =
          {equals("step along x2, alpha 3 over alpha 1",
                  ratio(of("gd", first_step, kThree), of("gd", first_step)),
                  9,
                  1e-12),
           equals("alpha 5 over alpha 1",
                  ratio(of("gd", first_step, kFive), of("gd", first_step)),
                  25,
                  1e-12)}},
     {.id = "P3",
      .where = "Crux of the matter",
      .from = "quick",
      .says = "A large alpha needs a smaller rate; then x2 is there before x1",
      .conditions =
          {below("|x2| per step at 0.05, alpha 1", of("gd_large", growth), 1),
           above("alpha 5", of("gd_large", growth, kFive), 1),
           below("at 0.03, alpha 5", of("gd", growth, kFive), 1),
           below("steps to 1 % of x2 less those of x1, alpha 5",
                 difference(of("gd", steps_to_a_percent(1), kFive),
                            of("gd", steps_to_a_percent(0), kFive)),
                 0)}},
     {.id = "P4",
      .where = "Crux of the matter, Summary",
      .from = "quick",
      .says = "Newton, inverse gradients and the inverse simulator take the "
              "same way for every alpha, gradient descent does not",
      .conditions = {at_most("Newton", apart("newton"), kExact),
                     at_most("inverse gradients", apart("ig"), kExact),
                     at_most("inverse simulator", apart("pg"), kExact),
                     above("gradient descent", apart("gd"), 0.1)}},
     {.id = "A1",
      .from = "smoke",
      .says = "x2 / x1 after a step of gradient descent over that before",
      .conditions =
          {equals("alpha 1", of("gd", ratio_kept), 1, 1e-12),
           within("alpha 3", of("gd", ratio_kept, kThree), 0.489, 0.490),
           within("alpha 5", of("gd", ratio_kept, kFive), -0.532, -0.531)}},
     {.id = "A2",
      .from = "smoke",
      .says = "Gradient descent at 0.05 and alpha = 5 grows by half each step",
      .conditions = {equals(
          "|x2| per step", of("gd_large", growth, kFive), 1.5, 1e-12)}},
     {.id = "A3",
      .from = "smoke",
      .says = "Steps that undo the scale are as long as rate |x|; gradient "
              "descent creeps along x1",
      .conditions = {
          at_most("Newton, off the rate", of("newton", off_the_rate), 1e-12),
          at_most("inverse gradients", of("ig", off_the_rate), 1e-12),
          at_most("inverse simulator", of("pg", off_the_rate), 1e-12),
          at_least("left of x1 by a step of gradient descent, alpha 5",
                   of("gd", left_of_x1, kFive),
                   0.92)}}});

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
Quantity mean_apart(const char* method) {
  const auto value = [](const Run& run) -> std::optional<double> {
    const auto other = run.beside({"pg"});
    if (!other) return {};
    return (Path(*run.stage).x() - Path(*other->stage).x()).cwiseAbs().mean();
  };
  return depends_on(median({method}, value), {{"pg"}});
}
Condition as_in_notebook(const char* label,
                         const char* method,
                         const OfPath& value,
                         const char* quantity,
                         double digit) {
  return equals(
      label, difference(of(method, value), printed(quantity)), 0, digit);
}

/// What single steps show.
const std::vector<Claim> kStepClaims = {
    {.id = "P11",
     .where = "Inverse gradients",
     .from = "smoke",
     .says = "What an inverse gradient step does to y does not depend on the "
             "inner function, what Newton's and gradient descent's do does",
     .conditions = {at_most("inverse gradient, largest over smallest",
                            identity("inner", spread_of_row(0)),
                            1 + kExact),
                    above("Newton", identity("inner", spread_of_row(1)), 1.4),
                    above("gradient descent",
                          identity("inner", spread_of_row(2)),
                          1e3)},
     .note = "y2 is 0.01, 1 and 250 times x2, and its square at 0.5, 1 and 3."},
    {.id = "P12",
     .where = "Fundamental theorem of calculus",
     .from = "smoke",
     .says = "dx / dy of the inverse simulator is the local gradient averaged "
             "over the way",
     .conditions = {at_most("off", identity("average", off_the_mean), 1e-9),
                    above("the local gradient alone, off at dy = -0.9 y",
                          identity("average", off_the_start),
                          0.5)}},
    {.id = "P13",
     .where = "Global and local inverse simulators",
     .from = "smoke",
     .says = "Near x0 the local inverse is the inverse, far from it it need "
             "not be",
     .conditions = {at_most("x^2 from 1, moved by half or less, off",
                            identity("local", inverse_off(true)),
                            kExact),
                    above("moved beyond 0, off",
                          identity("local", inverse_off(false)),
                          0.5)}},
    {.id = "P14",
     .where = "Quasi-Newton methods, Dependence on Hessian",
     .from = "smoke",
     .says = "Where the Hessian is singular Newton has no step, and another "
             "has to stand in",
     .conditions = {at_least("points where gradient over Hessian is no number",
                             identity("singular", quotients_lost),
                             1),
                    at_most("points without a step",
                            identity("singular", steps_lost),
                            0)}},
    {.id = "P15",
     .where = "Gradient descent, Function sensitivity",
     .from = "smoke",
     .says = "For alpha << 1 gradient descent hardly moves x2",
     .conditions = {below("its step at alpha 1e-3 over that at 1",
                          identity("small", share_at_small(1)),
                          1e-5),
                    equals("inverse gradient's",
                           identity("small", share_at_small(2)),
                           1,
                           kExact)}},
    {.id = "P16",
     .where = "Time reversal",
     .from = "smoke",
     .says = "Run backwards in time, the simulator of a reversible process is "
             "its inverse",
     .conditions = {below("distance of two oscillators from their start",
                          identity("reversed", reversal_end),
                          1e-4),
                    above("order in the time step",
                          identity("reversed", reversal_order),
                          3.5)}}};

const std::vector<Claim> kComparisonClaims(
    {{.id = "P2",
      .where = "Crux of the matter",
      .from = "smoke",
      .says = "L = alpha x: gradient descent changes it by -rate alpha^2",
      .conditions = {at_most("off", identity("linear", gd_off), kExact)}},
     {.id = "P5",
      .where = "Convergence",
      .from = "quick",
      .says = "Gradient descent stalls as the gradient vanishes; Newton keeps "
              "its pace",
      .conditions =
          {below("relative step along x2, last over first, gradient descent",
                 of("gd_small", relative_step_kept),
                 0.01),
           equals("Newton", of("newton_small", relative_step_kept), 1, 1e-9),
           equals("inverse gradients", of("ig", relative_step_kept), 1, 1e-9)},
      .note = "Relative to what is left: in x the steps of all shrink, where "
              "the chapter has them larger."},
     {.id = "P6",
      .where = "Inverse gradients",
      .from = "smoke",
      .says = "L = alpha x: an inverse gradient step changes it by what was "
              "asked, whatever alpha",
      .conditions = {at_most("off", identity("linear", ig_off), kExact)}},
     {.id = "P7",
      .where = "Inverse simulator",
      .from = "smoke",
      .says = "P(x + dx) = y + dy, also where P is not linear",
      .conditions = {at_most("missed by", of("pg", missed), kExact)}},
     {.id = "P8",
      .where = "Loss functions",
      .from = "smoke",
      .says = "The inverse simulator's step is the inverse gradient's up to "
              "O(dy^2)",
      .conditions = {within(
          "order of their distance", identity("order", slope), 1.9, 2.1)}},
     {.id = "P9",
      .where = "Local inverse",
      .from = "smoke",
      .says = "Of x^2, the root nearest to x0 is a local inverse",
      .conditions = {at_most("off", identity("roots", root_off), kExact),
                     at_most(
                         "wrong ones", identity("roots", wrong_branch), 0)}},
     {.id = "P10",
      .where = "notebook of the chapter",
      .from = "smoke",
      .says = "The digits printed after ten steps",
      .conditions =
          {as_in_notebook("GD, x1", "gd", end(0), "gd/x1", 2e-6),
           as_in_notebook("x2", "gd", end(1), "gd/x2", 2e-6),
           as_in_notebook("Newton, x1", "newton", end(0), "newton/x1", 2e-6),
           as_in_notebook("x2", "newton", end(1), "newton/x2", 2e-6),
           as_in_notebook("PG, x1", "pg", end(0), "pg/x1", 2e-6),
           as_in_notebook("x2", "pg", end(1), "pg/x2", 2e-6),
           as_in_notebook(
               "PG-numeric, x1", "pg_numeric", end(0), "pg-numeric/x1", 5e-6),
           as_in_notebook("x2", "pg_numeric", end(1), "pg-numeric/x2", 5e-6),
           as_in_notebook("distance, GD", "gd", distance, "gd/distance", 0.005),
           as_in_notebook(
               "Newton", "newton", distance, "newton/distance", 0.0005),
           as_in_notebook("PG", "pg", distance, "pg/distance", 0.005),
           as_in_notebook(
               "diagonal length, GD", "gd", diagonal, "gd/diagonal", 2e-6),
           as_in_notebook(
               "Newton", "newton", diagonal, "newton/diagonal", 2e-6),
           as_in_notebook("PG", "pg", diagonal, "pg/diagonal", 2e-6)}},
     {.id = "A1",
      .from = "smoke",
      .says = "PG ends nearest and starts straightest, then Newton, then GD",
      .conditions = {below("distance, PG / Newton",
                           ratio(of("pg", distance), of("newton", distance)),
                           1),
                     below("Newton / GD",
                           ratio(of("newton", distance), of("gd", distance)),
                           1),
                     above("diagonal length, PG / Newton",
                           ratio(of("pg", diagonal), of("newton", diagonal)),
                           1),
                     above("Newton / GD",
                           ratio(of("newton", diagonal), of("gd", diagonal)),
                           1)}},
     {.id = "A2",
      .from = "smoke",
      .says = "In y only PG goes straight",
      .conditions = {at_most("|y2 - 3 y1|, PG", of("pg", off_the_line), 1e-12),
                     above("Newton", of("newton", off_the_line), 1),
                     above("GD", of("gd", off_the_line), 1)}},
     {.id = "A3",
      .from = "smoke",
      .says = "An inverse by search takes PG's way",
      .conditions =
          {at_most(
               "mean distance, differences", mean_apart("pg_numeric"), 5e-6),
           at_most("exact gradients", mean_apart("pg_numeric_exact"), 1e-7)}},
     {.id = "A4",
      .says = "Newton at 1/2 leaves 3/1024 of x1",
      .conditions = {equals("1024 x1 / 3",
                            times(1024.0 / 3, of("newton_large", end(0))),
                            1,
                            1e-12)}}});

}  // namespace

void add_claims(Registry& r) {
  r.add_claims(kScaling, kScalingClaims);
  r.add_claims(kComparison, kComparisonClaims);
  r.add_claims(kComparison, kStepClaims);
}

}  // namespace physinv::scaling
