#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "problems/billiards/billiards.h"
#include "tests/problems/billiards_support.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

template <class A>
Vector<double> as_vector(const std::array<A, 2>& a) {
  return Eigen::Vector2d(a[0], a[1]);
}

/// |v| / (n.v) of a hit, at least 1: the Jacobian grows like it.
double conditioning(const Json& c) {
  if (c.at("collision").is_null()) return 1;
  const Vector<double> v = vector(c.at("v0"), 2);
  return std::max(1.0,
                  v.norm() / v.dot(vector(c.at("collision").at("normal"), 2)));
}

/// The table that the description states.
BilliardsOptions table_of(const Json& entry) {
  BilliardsOptions o;
  o.radius = setting(entry, "r", "\\br", o.radius);
  o.elasticity = setting(entry, "e", "\\be", o.elasticity);
  o.drag = setting(entry, "mu", "\\bmu", o.drag);
  return o;
}

template <class F>
EntryCheck for_cases(F check) {
  return [=](const Json& entry) {
    ASSERT_FALSE(entry.at("cases").empty());
    for (const Json& c : entry.at("cases")) {
      SCOPED_TRACE(c.dump());
      check(c, table_of(entry), EntryTolerance(entry).array(conditioning(c)));
    }
  };
}

void expect_collision(const Collision<double>& at,
                      const Json& e,
                      const Comparator& same) {
  const auto scalar = [&](double value, const char* key) {
    EXPECT_TRUE(same(value, number(e.at(key)))) << key;
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

void check_in_double(const Json& c,
                     const BilliardsOptions& table,
                     const Comparator& same) {
  const Point v = c.at("v0"), ball = c.at("ball");
  const auto r = evaluate_one<double>(v, ball, table);
  const auto at = collide<double>(v, ball, table);
  ASSERT_EQ(at.hit, c.at("hit").get<bool>());
  EXPECT_TRUE(same(r.y.col(0), vector(c.at("final_ball"))));
  EXPECT_TRUE(same(as_vector(at.final_ball), vector(c.at("final_ball"))));
  const Eigen::Map<const Eigen::Matrix2d> j(r.jacobian.data());
  EXPECT_TRUE(same(j, rows(c.at("jacobian"))));
  EXPECT_TRUE(same(r.loss(0), number(c.at("loss"))));
  EXPECT_TRUE(same(r.x_bar.col(0), vector(c.at("gradient"))));
  ASSERT_NE(at.hit, c.at("collision").is_null());
  if (at.hit) expect_collision(at, c.at("collision"), same);
}

/// Near grazing and near standstill float thresholds say miss: left out.
void check_in_float(const Json& c,
                    const BilliardsOptions& table,
                    const Comparator&) {
  const Point v = c.at("v0"), ball = c.at("ball");
  const double k = conditioning(c);
  const auto exact = collide<double>(v, ball, table);
  if (exact.hit && (k > 1 / 5e-3 || 1 - table.drag * exact.s < 1e-5)) return;
  const auto r = evaluate_one<float>(v, ball, table);
  const auto at = collide<float>(
      {float(v[0]), float(v[1])}, {float(ball[0]), float(ball[1])}, table);
  ASSERT_EQ(at.hit, c.at("hit").get<bool>());
  EXPECT_TRUE(Comparator(1e-5, 0)(r.y.col(0), vector(c.at("final_ball"))));
  const double loss = c.at("loss");
  EXPECT_LE(std::abs(r.loss(0) - loss), 1e-5 * (loss + std::sqrt(loss)));
  const Vector<double> g = vector(c.at("gradient"));
  const double allowed = 2e-5 * (g.cwiseAbs().maxCoeff() + 1) * k;
  EXPECT_TRUE(Comparator(0, allowed)(r.x_bar.col(0), g));
}

TEST(BilliardsReference, InBothPrecisions) {
  check_entries_named(
      "jpo-billiards",
      "simulate",
      in_both(for_cases(check_in_float), for_cases(check_in_double)));
}

}  // namespace
}  // namespace physinv::test
