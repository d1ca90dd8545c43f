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

enum Slot : std::size_t { kDerivatives, kCount };

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

template <class T>
RoboticArm<T>::RoboticArm(const Options& options) : options_(options) {
  for (const double l : options.links) {
    check_numbers<T>({{"links", l}});
    SUITE_CHECK(l > 0, "links must have a length");
  }
  for (const double m : options.mean) check_numbers<T>({{"mean", m}});
  for (const double s : options.deviation) check_numbers<T>({{"deviation", s}});
  for (const double s : options.deviation)
    SUITE_CHECK(s >= 0, "deviations must not be negative");
}

template <class T>
Vector<double> RoboticArm<T>::start() const {
  return Eigen::Map<const Eigen::Vector4d>(options_.mean.data());
}

template <class T>
Samples<double> RoboticArm<T>::sample(Index first,
                                      Index count,
                                      const Rng& rng) const {
  Samples<double> out;
  out.x.resize(4, count), out.y.resize(2, count), out.given.resize(0, count);
  for (Index i = 0; i < count; ++i) {
    Stream stream = rng.child(static_cast<std::uint64_t>(first + i)).stream();
    for (std::size_t j = 0; j < 4; ++j)
      out.x(static_cast<Index>(j), i) =
          options_.mean[j] + options_.deviation[j] * stream.normal();
  }
  Workspace work;
  RoboticArm<double>(options_).forward(out.x, out.given, out.y, work);
  return out;
}

template <class T>
void RoboticArm<T>::forward(BatchIn<T> x,
                            BatchIn<T> /*given*/,
                            BatchOut<T> y,
                            Workspace& /*work*/) const {
  check_size(x, 4, x.cols());
  check_size(y, 2, x.cols());
  for_arms<T>(options_, x, [&](Index b, Reach<T>& arms) {
    Lanes<T>(arms.y, 2).store(y, b * kLanes<T>);
  });
}

template <class T>
void RoboticArm<T>::linearize(BatchIn<T> x,
                              BatchIn<T> /*given*/,
                              BatchOut<T> y,
                              Tape& tape) const {
  check_size(x, 4, x.cols());
  check_size(y, 2, x.cols());
  const Index blocks = Lanes<T>::blocks(x.cols());
  auto kept = tape.slot<T>(kDerivatives, 6 * kLanes<T>, blocks);
  tape.slot<Index>(kCount, 1, 1)(0, 0) = x.cols();
  for_arms<T>(options_, x, [&](Index b, Reach<T>& arms) {
    Lanes<T>(arms.y, 2).store(y, b * kLanes<T>);
    std::memcpy(kept.col(b).data(), arms.d, sizeof(arms.d));
  });
}

template <class T>
void RoboticArm<T>::pullback(const Tape& tape,
                             BatchIn<T> y_bar,
                             BatchOut<T> x_bar,
                             Workspace& /*work*/) const {
  using P = Pack<T>;
  const Index count = tape.view<Index>(kCount)(0, 0);
  const auto kept = tape.view<T>(kDerivatives);
  check_size(y_bar, 2, count);
  check_size(x_bar, 4, count);
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

template <class T>
void RoboticArm<T>::jacobian(BatchIn<T> x,
                             BatchIn<T> /*given*/,
                             BatchOut<T> j,
                             Workspace& /*work*/) const {
  check_size(x, 4, x.cols());
  check_size(j, 8, x.cols());
  for_arms<T>(options_, x, [&](Index b, Reach<T>& arms) {
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

template class RoboticArm<float>;
template class RoboticArm<double>;

}  // namespace physinv
