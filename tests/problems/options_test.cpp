// Options that no problem can have are refused by name: what is not a number,
// and in float what is infinite or 0 there.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "problems/billiards/billiards.h"
#include "problems/exponential/exponential.h"
#include "problems/heat/heat.h"
#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "problems/marker_flow/marker_flow.h"
#include "problems/navier_stokes/navier_stokes.h"
#include "problems/noisy_absolute/noisy_absolute.h"
#include "problems/oscillators/oscillators.h"
#include "problems/poisson/poisson.h"
#include "problems/quantum_dipole/quantum_dipole.h"
#include "problems/robotic_arm/robotic_arm.h"
#include "problems/scaled_output/scaled_output.h"
#include "problems/scaling/scaling.h"
#include "problems/sine_plane/sine_plane.h"
#include "problems/wave_packet/wave_packet.h"
#include "suite/core/check.h"

namespace physinv {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// What is said of a problem in T; nothing if it is made.
template <class T = double>
std::string said(const ProblemRecipe& recipe) {
  try {
    recipe.make<T>();
  } catch (const ContractError& e) {
    return e.what();
  }
  return {};
}

void expect_line(const std::string& line) {
  EXPECT_NE(line, "");
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
}

/// Each of `numbers` is a field that is a number.
template <class Options>
void expect_numbers(
    ProblemRecipe (*recipe)(const Options&),
    const std::vector<std::function<double&(Options&)>>& numbers,
    Options options = {}) {
  EXPECT_EQ(said(recipe(options)), "");
  EXPECT_EQ(said<float>(recipe(options)), "");
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    SCOPED_TRACE(i);
    for (const double bad : {kNan, kInf, -kInf}) {
      Options spoilt = options;
      numbers[i](spoilt) = bad;
      expect_line(said(recipe(spoilt)));
      expect_line(said<float>(recipe(spoilt)));
    }
    for (const double far : {1e100, 1e-100}) {
      Options spoilt = options;
      numbers[i](spoilt) = far;
      expect_line(said<float>(recipe(spoilt)));
    }
  }
}

TEST(ProblemOptions, Billiards) {
  using O = BilliardsOptions;
  expect_numbers<O>(problems::billiards,
                    {[](O& o) -> double& { return o.radius; },
                     [](O& o) -> double& { return o.elasticity; },
                     [](O& o) -> double& { return o.drag; },
                     [](O& o) -> double& { return o.cue[0]; },
                     [](O& o) -> double& { return o.cue[1]; },
                     [](O& o) -> double& { return o.ball_x; },
                     [](O& o) -> double& { return o.ball_y[0]; },
                     [](O& o) -> double& { return o.ball_y[1]; },
                     [](O& o) -> double& { return o.target[0]; },
                     [](O& o) -> double& { return o.target[1]; },
                     [](O& o) -> double& { return o.start[0]; },
                     [](O& o) -> double& { return o.start[1]; },
                     [](O& o) -> double& { return o.velocity_spread; }});
  expect_line(said(problems::billiards({.velocity_spread = -1})));
  expect_line(said(problems::billiards({.ball_y = {1, 0}})));
}

TEST(ProblemOptions, Exponential) {
  using O = ExponentialOptions;
  expect_numbers<O>(problems::exponential,
                    {[](O& o) -> double& { return o.lowest; }});
  expect_line(said(problems::exponential({.lowest = 0})));
}

TEST(ProblemOptions, Heat) {
  using O = HeatOptions;
  expect_numbers<O>(problems::heat,
                    {[](O& o) -> double& { return o.end_time; },
                     [](O& o) -> double& { return o.noise_floor; }},
                    {.resolution = 8});
  for (const Index n : {0, -8, 4, 12})
    expect_line(said(problems::heat({.resolution = n})));
}

TEST(ProblemOptions, KuramotoSivashinsky) {
  using O = KuramotoSivashinskyOptions;
  expect_numbers<O>(problems::kuramoto_sivashinsky,
                    {[](O& o) -> double& { return o.box; },
                     [](O& o) -> double& { return o.time_step; },
                     [](O& o) -> double& { return o.prior_low; },
                     [](O& o) -> double& { return o.prior_high; },
                     [](O& o) -> double& { return o.start[0]; },
                     [](O& o) -> double& { return o.start[1]; }},
                    {.cells = 16, .steps = 2});
  expect_line(said(problems::kuramoto_sivashinsky({.tape_budget = kNan})));
  expect_line(said(problems::kuramoto_sivashinsky({.tape_budget = -1})));
}

TEST(ProblemOptions, MarkerFlow) {
  using O = MarkerFlowOptions;
  expect_numbers<O>(problems::marker_flow,
                    {[](O& o) -> double& { return o.box; },
                     [](O& o) -> double& { return o.end_time; },
                     [](O& o) -> double& { return o.falloff; },
                     [](O& o) -> double& { return o.threshold; },
                     [](O& o) -> double& { return o.fill[0]; },
                     [](O& o) -> double& { return o.fill[1]; },
                     [](O& o) -> double& { return o.half; },
                     [](O& o) -> double& { return o.vortex; },
                     [](O& o) -> double& { return o.width; },
                     [](O& o) -> double& { return o.moment; },
                     [](O& o) -> double& { return o.noise; },
                     [](O& o) -> double& { return o.correction; }},
                    {.cells = 8});
}

TEST(ProblemOptions, NavierStokes) {
  using O = NavierStokesOptions;
  expect_numbers<O>(problems::navier_stokes,
                    {[](O& o) -> double& { return o.box; },
                     [](O& o) -> double& { return o.end_time; },
                     [](O& o) -> double& { return o.height; },
                     [](O& o) -> double& { return o.width; },
                     [](O& o) -> double& { return o.speed; },
                     [](O& o) -> double& { return o.noise; },
                     [](O& o) -> double& { return o.x0[0]; },
                     [](O& o) -> double& { return o.x0[1]; },
                     [](O& o) -> double& { return o.vx[0]; },
                     [](O& o) -> double& { return o.vx[1]; },
                     [](O& o) -> double& { return o.vy[0]; },
                     [](O& o) -> double& { return o.vy[1]; }});
  expect_line(said(problems::navier_stokes({.vx = {1, -1}})));
  expect_line(said(problems::navier_stokes({.tape_budget = kNan})));
}

TEST(ProblemOptions, NoisyAbsolute) {
  using O = NoisyAbsoluteOptions;
  expect_numbers<O>(problems::noisy_absolute,
                    {[](O& o) -> double& { return o.gamma; },
                     [](O& o) -> double& { return o.omega_min; },
                     [](O& o) -> double& { return o.omega_max; },
                     [](O& o) -> double& { return o.level; },
                     [](O& o) -> double& { return o.decades; },
                     [](O& o) -> double& { return o.snr; }});
}

TEST(ProblemOptions, Oscillators) {
  using O = OscillatorsOptions;
  expect_numbers<O>(problems::oscillators,
                    {[](O& o) -> double& { return o.dt; },
                     [](O& o) -> double& { return o.coupling; },
                     [](O& o) -> double& { return o.control; },
                     [](O& o) -> double& { return o.deviation; }});
  expect_line(said(problems::oscillators({.deviation = -1})));
}

TEST(ProblemOptions, Poisson) {
  // Computed in double whatever T is.
  for (const double bad : {kNan, kInf, -1.0}) {
    expect_line(said(problems::poisson({.relative = bad})));
    expect_line(said<float>(problems::poisson({.relative = bad})));
  }
  expect_line(said(problems::poisson({.rows = -4})));
  expect_line(said(problems::poisson({.columns = 0})));
  expect_line(said(problems::poisson({.most = 0})));
  EXPECT_EQ(said<float>(problems::poisson({.relative = 1e-100})), "");
}

TEST(ProblemOptions, QuantumDipole) {
  using O = QuantumDipoleOptions;
  expect_numbers<O>(problems::quantum_dipole,
                    {[](O& o) -> double& { return o.dt; },
                     [](O& o) -> double& { return o.deviation; }});
  expect_line(said(problems::quantum_dipole({.angles = {0, kNan}})));
  expect_line(said(problems::quantum_dipole({.deviation = -1})));
}

TEST(ProblemOptions, RoboticArm) {
  using O = RoboticArmOptions;
  expect_numbers<O>(problems::robotic_arm,
                    {[](O& o) -> double& { return o.links[0]; },
                     [](O& o) -> double& { return o.links[2]; },
                     [](O& o) -> double& { return o.mean[3]; },
                     [](O& o) -> double& { return o.deviation[1]; }});
}

TEST(ProblemOptions, ScaledOutput) {
  using O = ScaledOutputOptions;
  expect_numbers<O>(problems::scaled_output,
                    {[](O& o) -> double& { return o.gamma; }});
}

TEST(ProblemOptions, Scaling) {
  using O = ScalingOptions;
  expect_numbers<O>(problems::scaling,
                    {[](O& o) -> double& { return o.scales[1]; },
                     [](O& o) -> double& { return o.start[0]; },
                     [](O& o) -> double& { return o.start[1]; }},
                    {.scales = {1, 3}});
  // Double can hold them.
  for (const double alpha : {1e100, 1e-100, -1e-160}) {
    EXPECT_EQ(said(problems::scaling({.scales = {alpha}})), "");
    const std::string line =
        said<float>(problems::scaling({.scales = {alpha}}));
    EXPECT_NE(line.find("scales = "), std::string::npos) << line;
    EXPECT_NE(line.find("range of float"), std::string::npos) << line;
  }
  EXPECT_EQ(said<float>(problems::scaling({.scales = {1e38, 1e-38}})), "");
  expect_line(said(problems::scaling({.scales = {0}})));
}

TEST(ProblemOptions, SinePlane) {
  using O = SinePlaneOptions;
  expect_numbers<O>(problems::sine_plane,
                    {[](O& o) -> double& { return o.gamma; },
                     [](O& o) -> double& { return o.xi; },
                     [](O& o) -> double& { return o.degrees; }});
  expect_line(said(problems::sine_plane({.limit = kNan})));
}

TEST(ProblemOptions, WavePacket) {
  using O = WavePacketOptions;
  expect_numbers<O>(problems::wave_packet,
                    {[](O& o) -> double& { return o.amplitude; },
                     [](O& o) -> double& { return o.frequency; },
                     [](O& o) -> double& { return o.phase; },
                     [](O& o) -> double& { return o.width; },
                     [](O& o) -> double& { return o.centre; },
                     [](O& o) -> double& { return o.scale; },
                     [](O& o) -> double& { return o.noise; },
                     [](O& o) -> double& { return o.range[0]; },
                     [](O& o) -> double& { return o.range[1]; }});
}

}  // namespace
}  // namespace physinv
