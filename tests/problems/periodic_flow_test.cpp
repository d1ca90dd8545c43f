// The step back of a flow with a marker is the transpose of its tangent, which
// is put together here from the tangents of its parts.
#include "problems/marker_flow/periodic_flow.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/planes.h"

namespace physinv::test {
namespace {

using P8 = fluid::Samples8<double>;
using Field = Packs<P8>;
using Fields = std::array<Field, 3>;  // u, v, m

constexpr Index kSide = 16;
constexpr double kLambda = 0.7;

MarkerState<P8> state_of(Fields& f) {
  return {f[0].data(), f[1].data(), f[2].data()};
}

class PeriodicFlowStep : public testing::Test {
 protected:
  PeriodicFlowStep() {
    s_ = {before_[0].data(),
          before_[1].data(),
          before_[2].data(),
          back_[0].data(),
          back_[1].data(),
          back_[2].data(),
          energy_};
    std::uint8_t** held[] = {&s_.u_held, &s_.v_held, &s_.m_held};
    for (int k = 0; k < 3; ++k) {
      decisions_[k].resize(std::size_t(flow_.decisions()));
      *held[k] = decisions_[k].data();
    }
    flow_.advance(s_, state_of(after_), memory_.data());
  }

  /// Numbers without structure, with their padding.
  Fields rough(double shift) const {
    Fields all;
    for (int k = 0; k < 3; ++k) {
      Batch<double> a(kSide, kSide);
      for (Index i = 0; i < a.size(); ++i) {
        const double x = shift + 300.0 * k + double(i);
        a(i) = std::sin(12.9898 * (x * x + 3 * x + 1));
      }
      all[k] = to_plane<P8>(plane_, a);
      wrap(plane_, all[k].data());
    }
    return all;
  }
  double dot(const Fields& a, const Fields& b, int fields = 3) const {
    double sum = 0;
    for (int k = 0; k < fields; ++k)
      sum +=
          from_plane(plane_, a[k]).cwiseProduct(from_plane(plane_, b[k])).sum();
    return sum;
  }

  template <int kAxis>
  auto across(const Fields& f) const {
    return fluid::face_velocity<fluid::Edge::periodic, kAxis>(
        f[kAxis].data(), f[1 - kAxis].data(), plane_.stride);
  }
  CentreVelocity<P8> centres(const Fields& f) const {
    return {f[0].data(), f[1].data(), plane_.stride};
  }

  Fields tangent(Fields dot_in) {
    Fields out;
    for (auto& f : out) f = blank<P8>(plane_);
    const auto push = [&](int k, const auto& velocity, const auto& moved) {
      advection_.push(before_[k].data(),
                      back_[k].data(),
                      velocity,
                      decisions_[k].data(),
                      dot_in[k].data(),
                      moved,
                      out[k].data(),
                      memory_.data());
    };
    push(0, across<0>(before_), across<0>(dot_in));
    push(1, across<1>(before_), across<1>(dot_in));
    projection_.project(out[0].data(), out[1].data(), memory_.data());

    const double first = energy_[0][0], last = energy_[1][0];
    const double scale = std::sqrt(first / last), cells = kSide * kSide;
    // `after_` is `scale` times what was projected.
    const double grows = dot(before_, dot_in, 2) / (first * cells) -
                         dot(after_, out, 2) / (scale * last * cells);
    for (int k = 0; k < 2; ++k) {
      for (std::size_t a = 0; a < out[k].size(); ++a)
        out[k][a] = scale * out[k][a] + grows * after_[k][a];
      wrap(plane_, out[k].data());
    }
    push(2, centres(after_), centres(out));
    return out;
  }

  const PeriodicFlow<P8> flow_{kSide, kLambda};
  const fluid::Plane plane_ = flow_.plane();
  const fluid::PeriodicProjection<double> projection_{kSide};
  const fluid::MacCormack<fluid::Edge::periodic, P8> advection_{plane_,
                                                                kLambda};
  Field memory_ = scratch<P8>(plane_);
  Fields before_ = rough(1), after_ = rough(2), back_ = rough(3);
  std::vector<std::uint8_t> decisions_[3];
  P8 energy_[2];
  MarkerStep<P8> s_;
};

TEST_F(PeriodicFlowStep, BackIsTheTransposeOfTheTangent) {
  const Fields moved = rough(7000), bar = rough(9000);
  Fields lost = bar, out = rough(4);
  for (auto& f : lost) {  // without padding
    const auto inner = from_plane(plane_, f);
    f = to_plane<P8>(plane_, inner);
  }
  flow_.retreat(
      s_, state_of(after_), state_of(lost), state_of(out), memory_.data());
  const double back = dot(out, moved), there = dot(bar, tangent(moved));
  EXPECT_GT(std::abs(there), 1e-2);
  EXPECT_NEAR(
      back, there, 1e-12 * std::sqrt(dot(out, out) * dot(moved, moved)));
}

/// Nothing to scale: no energy before.
TEST_F(PeriodicFlowStep, AtRestNothingIsScaled) {
  for (int k = 0; k < 2; ++k)
    std::fill(before_[k].begin(), before_[k].end(), P8{});
  flow_.advance(s_, state_of(after_), memory_.data());
  EXPECT_EQ(from_plane(plane_, after_[2]), from_plane(plane_, before_[2]));
  Fields bar = rough(5), out = rough(6);
  for (int k = 0; k < 2; ++k) bar[k] = blank<P8>(plane_);
  flow_.retreat(
      s_, state_of(after_), state_of(bar), state_of(out), memory_.data());
  for (const auto& f : out) EXPECT_TRUE(from_plane(plane_, f).allFinite());
}

}  // namespace
}  // namespace physinv::test
