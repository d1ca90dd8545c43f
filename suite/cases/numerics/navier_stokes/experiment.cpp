// Wind in a box: any speed, grid and arrangement of obstacles, and what its
// time steps cost.
#include <array>
#include <vector>

#include "problems/navier_stokes/navier_stokes.h"
#include "suite/cases/numerics/common/atlas.h"

namespace physinv::numerics::navier_stokes {
namespace {

/// Blasts from still air to far beyond what the paper draws, two steps long;
/// at speed 1 on 64 cells a step crosses 1.3 cells.
const SweepAxis kSpeeds{"speed", {0, 0.1, 1, 10, 100, 1e4, 1e6, 1e8}, true};

ProblemRecipe brief(Index cells, std::vector<fluid::Obstacle> obstacles) {
  return problems::navier_stokes({.cells = cells,
                                  .end_time = 4,
                                  .steps = 2,
                                  .obstacles = std::move(obstacles)});
}

Vector<double> blast(double speed, double) {
  return Eigen::Vector3d(0.1, 0.6 * speed / 5, 0.8 * speed / 5 - 1);
}

const SweepAxis kGrids{"cells a side", {16, 32, 64, 128, 256}, true};
/// One box below the middle.
ProblemRecipe on_grid(double side) {
  const auto n = static_cast<Index>(side);
  return brief(n, {{n / 4, n / 2, 3 * n / 8, 7 * n / 16}});
}

const SweepAxis kScenes{"scene", {0, 1, 2, 3, 4, 5}, false};
/// An empty box; the paper's; boxes on walls and in a corner; boxes that share
/// a side and a corner; a pocket without a way out; one of a single cell.
ProblemRecipe in_scene(double which) {
  static const std::array<std::vector<fluid::Obstacle>, 6> scenes = {{
      {},
      NavierStokesOptions{}.obstacles,
      {{0, 10, 24, 29}, {54, 64, 0, 9}, {20, 40, 60, 64}},
      {{20, 30, 24, 29}, {30, 36, 24, 35}, {36, 44, 35, 40}},
      {{20, 40, 34, 36}, {20, 40, 44, 46}, {20, 22, 36, 44}, {38, 40, 36, 44}},
      {{20, 23, 34, 35}, {20, 23, 36, 37}, {20, 21, 35, 36}, {22, 23, 35, 36}},
  }};
  return brief(64, scenes[static_cast<std::size_t>(which)]);
}

const SweepAxis kTimeSteps{"time step", {8, 4, 2, 1}, true};
ProblemRecipe stepping(double step) {
  return problems::navier_stokes({.steps = static_cast<Index>(56 / step)});
}

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(r,
            {.name = "numerics/navier-stokes",
             .title = "Numerics of wind in a box",
             .citation = {.paper = "jpo", .where = "App. D.4"},
             .sweeps = {{.id = "grids",
                         .title = "Speed and grid",
                         .x = kSpeeds,
                         .y = kGrids,
                         .point = blast,
                         .problems = along(kGrids, on_grid)},
                        {.id = "scenes",
                         .title = "Speed and obstacles",
                         .x = kSpeeds,
                         .y = kScenes,
                         .point = blast,
                         .problems = along(kScenes, in_scene)}},
             .parameters = {{.id = "steps",
                             .title = "Time steps",
                             .axis = kTimeSteps,
                             .problems = along(kTimeSteps, stepping),
                             .reference = stepping(0.5),
                             .samples = 2,
                             .repetitions = 2}},
             .problem = problems::navier_stokes()});
}

}  // namespace physinv::numerics::navier_stokes
