#include "problems/robotic_arm/robotic_arm.h"

#include <cstring>

#include "suite/core/check.h"
#include "suite/core/math_lanes.h"
#include "suite/core/option_check.h"
#include "suite/core/simd/samples.h"

namespace physinv {
namespace {

/// One block of arms: tips and d[2 k], d[2 k + 1] = d_k.
template <class T>
struct Reach {
  Pack<T> y[2], d[6];
};

template <class T>
Reach<T> reach(const RoboticArmOptions& o, const Pack<T> (&x)[4]) {
  Reach<T> out;
  auto& [y, d] = out;
  y[0] = Pack<T>{}, y[1] = x[0];
  const Pack<T> phi[3] = {x[1], x[2] - x[1], x[3] - x[2] - x[1]};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [sine, cosine] = math::sincos(phi[k]);
    const T link = static_cast<T>(o.links[k]);
    const Pack<T> across = link * cosine, up = link * sine;
    y[0] += across, y[1] += up;
    d[2 * k] = -up, d[2 * k + 1] = across;
  }
  return out;
}

/// Runs body(block, reach) for every block of columns of x.
template <class T, class F>
void for_arms(const RoboticArmOptions& options, BatchIn<T> x, F&& body) {
  for (Index b = 0; b < Lanes<T>::blocks(x.cols()); ++b) {
    Pack<T> in[4];
    Lanes<T>(in, 4).load(x, b * kLanes<T>);
    Reach<T> arms = reach<T>(options, in);
    body(b, arms);
  }
}

enum Slot : std::size_t { kDerivatives };

}  // namespace

std::array<std::array<double, 2>, 4> arm_joints(const std::array<double, 4>& x,
                                                const RoboticArmOptions& o) {
  Pack<double> in[4]{};
  for (int j = 0; j < 4; ++j) in[j][0] = x[static_cast<std::size_t>(j)];
  const auto [y, d] = reach<double>(o, in);
  std::array<std::array<double, 2>, 4> at{};
  at[0] = {0, x[0]};
  for (std::size_t k = 0; k < 3; ++k)
    at[k + 1] = {at[k][0] + d[2 * k + 1][0], at[k][1] - d[2 * k][0]};
  return at;
}

namespace {

template <class T>
class RoboticArm final : public Problem<T>, public Vjp<T>, public Jacobian<T> {
 public:
  explicit RoboticArm(const RoboticArmOptions& options) : options_(options) {
    for (const double l : options.links) {
      check_numbers<T>({{"links", l}});
      SUITE_CHECK(l > 0, "links must have a length");
    }
    for (const double m : options.mean) check_numbers<T>({{"mean", m}});
    for (const double s : options.deviation)
      check_numbers<T>({{"deviation", s}});
    for (const double s : options.deviation)
      SUITE_CHECK(s >= 0, "deviations must not be negative");
  }

  Shape shape() const override { return {4, 2, 0}; }
  Vector<double> start() const override {
    return Eigen::Map<const Eigen::Vector4d>(options_.mean.data());
  }

  /// x ~ N(mean, deviation^2): every tip is in reach.
  void draw(Stream& stream, SampleOut& sample) const override {
    for (std::size_t j = 0; j < 4; ++j)
      sample.x(static_cast<Index>(j)) =
          options_.mean[j] + options_.deviation[j] * stream.normal();
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace&) const override {
    for_arms<T>(options_, at.x, [&](Index b, Reach<T>& arms) {
      Lanes<T>(arms.y, 2).store(y, b * kLanes<T>);
    });
  }
  /// Keeps d_1, d_2, d_3 per sample.
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const Index blocks = Lanes<T>::blocks(y.cols());
    auto kept = tape.slot<T>(kDerivatives, 6 * kLanes<T>, blocks);
    for_arms<T>(options_, at.x, [&](Index b, Reach<T>& arms) {
      Lanes<T>(arms.y, 2).store(y, b * kLanes<T>);
      std::memcpy(kept.col(b).data(), arms.d, sizeof(arms.d));
    });
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace&) const override {
    using P = Pack<T>;
    const auto kept = tape.view<T>(kDerivatives);
    for (Index b = 0; b < kept.cols(); ++b) {
      P d[6], r[2], t[3];
      std::memcpy(d, kept.col(b).data(), sizeof(d));
      Lanes<T>(r, 2).load(y_bar, b * kLanes<T>);
      for (int k = 0; k < 3; ++k)
        t[k] = fma_lanes(d[2 * k], r[0], d[2 * k + 1] * r[1]);
      P out[4] = {r[1], t[0] - t[1] - t[2], t[1] - t[2], t[2]};
      Lanes<T>(out, 4).store(x_bar, b * kLanes<T>);
    }
  }
  /// Rows of j: dy0/dx0, dy1/dx0, dy0/dx1, ...
  void jacobian(Point<T> at, BatchOut<T> j, Workspace&) const override {
    for_arms<T>(options_, at.x, [&](Index b, Reach<T>& arms) {
      const auto& d = arms.d;
      Pack<T> columns[8];
      for (int r = 0; r < 2; ++r) {
        columns[r] = Pack<T>{} + T(r);
        columns[2 + r] = d[r] - d[2 + r] - d[4 + r];
        columns[4 + r] = d[2 + r] - d[4 + r];
        columns[6 + r] = d[4 + r];
      }
      Lanes<T>(columns, 8).store(j, b * kLanes<T>);
    });
  }

  /// A sine with its cosine counts as 20.
  double operations() const override { return 75; }

 private:
  RoboticArmOptions options_;
};

}  // namespace

ProblemRecipe problems::robotic_arm(const RoboticArmOptions& options) {
  return problem<RoboticArm>(
      "robotic_arm",
      options,
      {.unknowns = {"height, angle_1, angle_2, angle_3", "1, rad, rad, rad"},
       .observations = {"x, y"}});
}

}  // namespace physinv
