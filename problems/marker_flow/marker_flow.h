/// An inviscid flow carries a marker: with which velocity did it start, if the
/// marker is seen at the start and at the end? (Scale-invariant physics
/// training, App. B.4, Figs. 14, 15.)
///
///   du/dt + u grad u = -grad p,  div u = 0,  dm/dt + u grad m = 0
///
/// on a periodic square, staggered. Each step: MacCormack advection with a
/// limiter of both components, exact projection, the total energy restored,
/// then the marker (periodic_flow.h). The first velocity is projected, too.
///
/// Unknown x: the initial velocity at the cells' centres (component, i, j).
/// Given: the marker's density at t = 0 (i, j). Observation y: that at the end.
/// Index j is the fastest. The loss is one of the densities' long waves
/// (frequency_loss.h), not half the squared error; the authors add a constant.
///
/// vjp: exact discrete adjoint. The map is continuous and has kinks everywhere
/// (limiter, cells).
///
/// invert: an analytic estimate, no exact inverse. The final velocity of the
/// guess, turned round, carries the observed marker back. A uniform flow that
/// brings the marker to the middle, plus a vortex there: that of the guess,
/// corrected by the distance of the centres of mass on both ways across the
/// direction to the vortex. Shorter waves are deliberately left out.
///
/// Numbers that are not finite, or beyond 1e6, give NaN in their own column.
///
/// `sample` draws a fill fraction for every example; the authors draw one for
/// each batch.
///
/// Speed: eight samples side by side. A sample's forward pass takes 0.5 ms in
/// float and 0.6 in double, its gradient 1.6 and 2.1 (PyTorch in float, 16 of
/// them together: 9 to 11, 14 to 16).
#pragma once

#include <array>
#include <memory>

#include "problems/marker_flow/frequency_loss.h"
#include "problems/marker_flow/markers.h"
#include "suite/core/recipe.h"

namespace physinv {

struct MarkerFlowOptions {
  Index cells = 64;  ///< per side, a power of two
  double box = 128;  ///< length of a side
  double end_time = 2;
  Index steps = 8;
  double falloff = 80, threshold = 1e-5;  ///< of the loss
  std::array<double, 2> fill = {0.05, 0.15};
  double half = 28;       ///< half a side of the square that holds the marker
  double vortex = 2;      ///< largest strength of the vortex
  double width = 20;      ///< of the vortex
  double moment = 120.5;  ///< see Vortex
  double noise = 0.1;     ///< standard deviation of the small scales
  double correction = 1e-3;  ///< of the vortex, by the mean cross product
  /// Where the vortex is thought to be on the way back: after the time itself,
  /// or after the number of steps as in the authors' code.
  bool timed_path = false;

  MarkerGrid grid() const { return {cells, box}; }
  Vortex turning() const { return {grid(), width, moment}; }

  auto fields() const {
    return std::tuple{field("cells", cells),
                      field("box", box),
                      field("end_time", end_time),
                      field("steps", steps),
                      field("falloff", falloff),
                      field("threshold", threshold),
                      field("fill", fill),
                      field("half", half),
                      field("vortex", vortex),
                      field("width", width),
                      field("moment", moment),
                      field("noise", noise),
                      field("correction", correction),
                      field("timed_path", timed_path)};
  }
};

/// Of a marker flow; null of any other problem.
const MarkerFlowOptions* marker_flow_options(const Problem<double>& problem);

namespace problems {
ProblemRecipe marker_flow(const MarkerFlowOptions& options = {});
}

}  // namespace physinv
