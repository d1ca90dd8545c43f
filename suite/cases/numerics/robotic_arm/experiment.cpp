// The robotic arm where its Jacobian loses rank, and at angles far beyond a
// turn.
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "problems/robotic_arm/robotic_arm.h"
#include "suite/cases/numerics/common/sweep_report.h"
#include "suite/diagnostics/stability_sweep.h"
#include "suite/harness/registry.h"

namespace physinv {
namespace {

constexpr const char* kName = "numerics/robotic-arm";

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

const SweepAxis kDirection{"direction of the first link", turn()};
const SweepAxis kBend{"bend of both joints", bends()};

ProblemRecipe arm() { return problem<RoboticArm>("robotic_arm"); }

/// Bends of 0 and pi, where all links lie on one line, are singular: the middle
/// row of the grid and its ends.
std::shared_ptr<const Stage> poses() {
  StabilitySweepOptions options{
      .name = "poses", .problems = {arm()}, .points = {}};
  for (const double bend : kBend.values)
    for (const double a : kDirection.values)
      options.points.push_back({0, pose(0.25, {a, a + bend, a - bend})});
  return stability_sweep(options);
}

std::vector<double> decades() {
  std::vector<double> sizes;
  for (int decade = 0; decade <= 16; ++decade)
    sizes.push_back(std::pow(10.0, decade));
  return sizes;
}

const SweepAxis kSize{"size of the angles", decades(), true};
const SweepAxis kStretch{"bend of both joints", {0, 0.5, 1}};

/// From a turn to where neighbouring numbers are turns apart.
std::shared_ptr<const Stage> turns() {
  StabilitySweepOptions options{
      .name = "turns", .problems = {arm()}, .points = {}};
  for (const double bend : kStretch.values)
    for (const double size : kSize.values)
      options.points.push_back({0, pose(0, {size, size + bend, size - bend})});
  return stability_sweep(options);
}

Section report(const Results& results, const Published&) {
  const auto* singular = find_sweep(results, kName, "stability", "poses");
  const auto* large = find_sweep(results, kName, "stability", "turns");
  return {
      .tables = {sweep_table("poses", "Singular poses and others", singular),
                 sweep_table("turns", "Large angles", large)},
      .figures = {sweep_maps("poses",
                             "Singular poses (bend 0 and ±pi) and others",
                             kDirection,
                             kBend,
                             singular),
                  sweep_maps("turns", "Large angles", kSize, kStretch, large)}};
}

const std::vector<Row> kRows = {
    {.methods = {"stability"}, .n = {1}, .seeds = {0}}};

/// Nothing is learned here.
const Setting kNoNetworks;

const auto kRegistered = register_experiment({
    .name = kName,
    .title = "Numerics of the robotic arm",
    .source = {.paper = "jpo", .where = "App. D.5"},
    .problem = arm(),
    .setting = kNoNetworks,
    .profiles = {{.name = "smoke", .rows = kRows},
                 {.name = "quick", .rows = kRows},
                 {.name = "paper", .rows = kRows}},
    .methods = {{"stability", {poses(), turns()}}},
    .claims = {adjoint_claim("N1", {"poses", "turns"})},
    .report = report,
});

}  // namespace
}  // namespace physinv
