#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "problems/billiards/billiards.h"
#include "tests/problems/billiards_support.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

constexpr double kDrag = BilliardsOptions{}.drag;

template <class A>
Vector<double> as_vector(const std::array<A, 2>& a) {
  return Eigen::Vector2d(a[0], a[1]);
}

/// |v| / (n.v) of a hit, at least 1: the Jacobian grows like it.
double conditioning(const Json& c) {
  if (c.at("collision").is_null()) return 1;
  const Vector<double> v = vector(c.at("v0"));
  return std::max(1.0,
                  v.norm() / v.dot(vector(c.at("collision").at("normal"))));
}

template <class F>
void for_cases(F&& check) {
  const auto entries = reference_entries("jpo-billiards", "simulate");
  ASSERT_FALSE(entries.empty());
  for (const Json& entry : entries) {
    ASSERT_FALSE(entry.at("cases").empty());
    for (const Json& c : entry.at("cases")) {
      SCOPED_TRACE(c.dump());
      check(c, EntryTolerance(entry).array(conditioning(c)));
    }
  }
}

void expect_collision(const Collision<double>& at,
                      const Json& e,
                      const Comparator& same) {
  const auto scalar = [&](double value, const char* key) {
    EXPECT_TRUE(same(value, e.at(key).get<double>())) << key;
  };
  const auto pair = [&](const Point& value, const char* key) {
    EXPECT_TRUE(same(as_vector(value), vector(e.at(key)))) << key;
  };
  scalar(at.s, "s");
  scalar(at.time, "time");
  scalar(at.normal_speed, "normal_speed");
  pair(at.cue_at_contact, "cue_at_contact");
  pair(at.cue_velocity_before, "cue_velocity_before");
  pair(at.normal, "normal");
  pair(at.ball_velocity_after, "ball_velocity_after");
  pair(at.cue_velocity_after, "cue_velocity_after");
}

TEST(BilliardsReference, Double) {
  for_cases([](const Json& c, const Comparator& same) {
    const auto v = c.at("v0").get<Point>(), ball = c.at("ball").get<Point>();
    const auto r = evaluate_one<double>(v, ball);
    const auto at = collide<double>(v, ball);
    ASSERT_EQ(at.hit, c.at("hit").get<bool>());
    EXPECT_TRUE(same(r.y.col(0), vector(c.at("final_ball"))));
    EXPECT_TRUE(same(as_vector(at.final_ball), vector(c.at("final_ball"))));
    const Eigen::Map<const Eigen::Matrix2d> j(r.jacobian.data());
    EXPECT_TRUE(same(j, rows(c.at("jacobian"))));
    EXPECT_TRUE(same(r.loss(0), c.at("loss").get<double>()));
    EXPECT_TRUE(same(r.x_bar.col(0), vector(c.at("gradient"))));
    ASSERT_NE(at.hit, c.at("collision").is_null());
    if (at.hit) expect_collision(at, c.at("collision"), same);
  });
}

// Near grazing and near standstill float thresholds say miss: left out.
TEST(BilliardsReference, Float) {
  for_cases([](const Json& c, const Comparator&) {
    const auto v = c.at("v0").get<Point>(), ball = c.at("ball").get<Point>();
    const double k = conditioning(c);
    const auto exact = collide<double>(v, ball);
    if (exact.hit && (k > 1 / 5e-3 || 1 - kDrag * exact.s < 1e-5)) return;
    const auto r = evaluate_one<float>(v, ball);
    const auto at = collide<float>({float(v[0]), float(v[1])},
                                   {float(ball[0]), float(ball[1])});
    ASSERT_EQ(at.hit, c.at("hit").get<bool>());
    EXPECT_TRUE(Comparator(1e-5, 0)(r.y.col(0), vector(c.at("final_ball"))));
    const double loss = c.at("loss");
    EXPECT_LE(std::abs(r.loss(0) - loss), 1e-5 * (loss + std::sqrt(loss)));
    const Vector<double> g = vector(c.at("gradient"));
    const double allowed = 2e-5 * (g.cwiseAbs().maxCoeff() + 1) * k;
    EXPECT_TRUE(Comparator(0, allowed)(r.x_bar.col(0), g));
  });
}

}  // namespace
}  // namespace physinv::test
