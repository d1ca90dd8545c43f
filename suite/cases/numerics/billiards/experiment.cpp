// Billiards from head-on to grazing and past it, at any speed, and over the
// plane of velocities.
#include <algorithm>
#include <cmath>

#include "problems/billiards/billiards.h"
#include "suite/cases/numerics/billiards/closed_form.h"
#include "suite/cases/numerics/common/atlas.h"
#include "suite/core/power_of_ten.h"
#include "suite/evidence/series.h"

namespace physinv::numerics::billiards {
namespace {

/// The other ball one unit straight ahead.
const BilliardsOptions kAhead{.ball_y = {0.5, 0.5}};

/// Distances of the cue ball's line from the other's centre over 2 r: 0 is
/// head-on, 1 grazes. From either side as close as numbers come.
std::vector<double> offsets() {
  std::vector<double> all = {0, 0.5, 0.9};
  for (int k = 2; k <= 16; k += 2) all.push_back(1 - math::power_of_ten(-k));
  all.push_back(1);
  for (int k = 15; k >= 1; k -= 2) all.push_back(1 + math::power_of_ten(-k));
  return all;
}

Vector<double> aimed(double offset, double speed) {
  const double sine = offset * 2 * kAhead.radius;
  return speed * Eigen::Vector2d(std::sqrt(1 - sine * sine), sine);
}

Vector<double> velocity(double x, double y) { return Eigen::Vector2d(x, y); }

std::vector<double> speeds() {
  std::vector<double> all = {0};
  for (const double v : decades(-150, 150, 25)) all.push_back(v);
  for (const double v : {0.3, 0.5, 2.0, 10.0}) all.push_back(v);
  std::sort(all.begin(), all.end());
  return all;
}

const ProblemRecipe kBilliards = problems::billiards(kAhead);

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(
      r,
      {.name = "numerics/billiards",
       .title = "Numerics of billiards",
       .citation = {.paper = "jpo", .where = "Sec. 4"},
       .sweeps = {{.id = "grazing",
                   .title = "Aim, from head-on (0) past grazing (1), and speed",
                   .x = {"offset over 2 r", offsets()},
                   .y = {"speed", speeds()},
                   .point = aimed,
                   .problems = {kBilliards}},
                  {.id = "velocities",
                   .title = "The plane of velocities",
                   .x = {"velocity in x", spaced(-3, 3, 25)},
                   .y = {"velocity in y", spaced(-3, 3, 25)},
                   .point = velocity,
                   .problems = {kBilliards}}},
       .parameters = {batch_parameter(
           problems::billiards(), 1024, {}, billiards_closed_form())},
       .problem = problems::billiards()});
}

}  // namespace physinv::numerics::billiards
