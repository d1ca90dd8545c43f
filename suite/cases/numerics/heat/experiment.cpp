// Diffusion from weak to hopeless: where what is left of a wave still differs
// from rounding, and what the local inverse makes of it.
#include <fmt/format.h>

#include <numbers>

#include "problems/heat/heat.h"
#include "suite/cases/numerics/common/atlas.h"
#include "suite/cases/numerics/heat/closed_form.h"
#include "suite/core/math.h"

namespace physinv::numerics::heat {
namespace {

constexpr Index kSide = 16;

ProblemRecipe until(double end_time, double noise_floor = 0) {
  return problems::heat(
      {.resolution = kSide, .end_time = end_time, .noise_floor = noise_floor});
}

/// A wave along the diagonal.
Vector<double> wave(double k, double /*end_time*/) {
  return Vector<double>::NullaryExpr(kSide * kSide, [=](Index at) {
    const auto place = double((at / kSide + at % kSide) % kSide);
    return math::cos(2 * std::numbers::pi * k * place / kSide + 0.3);
  });
}

const SweepAxis kTimes{"end time", {1, 2, 4, 8, 16, 32, 64}, true};

/// What noise does, at one end time; the inverse's error is that of x.
NumericalParameter floor_parameter(double end_time) {
  const SweepAxis floors{fmt::format("end time {}, noise floor", end_time),
                         {1e-3, 1e-6, 1e-9, 1e-12},
                         true};
  return {
      .id = fmt::format("floor-{}", end_time),
      .title = fmt::format("Noise floor of the inverse, end time {}", end_time),
      .axis = floors,
      .problems =
          along(floors, [=](double floor) { return until(end_time, floor); }),
      .reference = until(end_time),
      .samples = 32};
}

/// Of so few cells that the sums of the closed form take no time.
constexpr HeatOptions kFew{.resolution = 8, .end_time = 1};

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(r,
            {.name = "numerics/heat",
             .title = "Numerics of heat",
             .citation = {.paper = "sip", .where = "App. B.3"},
             .sweeps = {{.id = "times",
                         .title = "Wave number and end time",
                         .x = {"wave number", {0, 1, 2, 3, 4, 5, 6, 7, 8}},
                         .y = kTimes,
                         .point = wave,
                         .problems = along(
                             kTimes,
                             [](double end_time) { return until(end_time); })}},
             .parameters = {
                 floor_parameter(1),
                 floor_parameter(8),
                 floor_parameter(64),
                 batch_parameter(
                     problems::heat(kFew), 32, {}, heat_closed_form(kFew))}});
}

}  // namespace physinv::numerics::heat
