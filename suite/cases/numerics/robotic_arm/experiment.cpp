// The robotic arm where its Jacobian loses rank, and at angles far beyond a
// turn.
#include <array>
#include <numbers>
#include <vector>

#include "problems/robotic_arm/robotic_arm.h"
#include "suite/cases/numerics/common/atlas.h"
#include "suite/cases/numerics/robotic_arm/closed_form.h"

namespace physinv::numerics::robotic_arm {
namespace {

/// Unknowns of an arm whose links point at these absolute angles.
Vector<double> pose(double base, const std::array<double, 3>& phi) {
  const double second = phi[1] + phi[0];
  return Eigen::Vector4d(base, phi[0], second, phi[2] + second + phi[0]);
}

std::vector<double> turn() {
  std::vector<double> angles;
  for (int k = 0; k <= 24; ++k) angles.push_back(k * std::numbers::pi / 12);
  return angles;
}

std::vector<double> bends() {
  std::vector<double> angles;
  for (int k = -8; k <= 8; ++k) angles.push_back(k * std::numbers::pi / 8);
  return angles;
}

/// Both links bent the same way by `bend`: 0 and pi, where all of them lie on
/// one line, are singular.
Vector<double> bent(double base, double direction, double bend) {
  return pose(base, {direction, direction + bend, direction - bend});
}

const ProblemRecipe kArm = problems::robotic_arm();

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(
      r,
      {.name = "numerics/robotic-arm",
       .title = "Numerics of the robotic arm",
       .citation = {.paper = "jpo", .where = "App. D.5"},
       .sweeps = {{.id = "poses",
                   .title = "Singular poses (bend 0 and ±pi) and others",
                   .x = {"direction of the first link", turn()},
                   .y = {"bend of both joints", bends()},
                   .point =
                       [](double direction, double bend) {
                         return bent(0.25, direction, bend);
                       },
                   .problems = {kArm}},
                  // From a turn to where neighbouring numbers are turns apart.
                  {.id = "turns",
                   .title = "Large angles",
                   .x = {"size of the angles", decades(0, 16), true},
                   .y = {"bend of both joints", {0, 0.5, 1}},
                   .point = [](double size,
                               double bend) { return bent(0, size, bend); },
                   .problems = {kArm}}},
       .parameters = {
           batch_parameter(kArm, 1024, {}, robotic_arm_closed_form())}});
}

}  // namespace physinv::numerics::robotic_arm
