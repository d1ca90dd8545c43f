/// Billiards: which initial velocity of the cue ball makes the ball it hits
/// come to rest at the target? (Joint parameter optimization, Sec. 4, Fig. 4.)
///
/// Two equal balls of radius r in the plane, elasticity e, drag dv/dt = -mu v,
/// no walls. With the travelled fraction s = (1 - exp(-mu t)) / mu the cue ball
/// is at p + v s with velocity (1 - mu s) v, so neither time nor exponentials
/// appear. With d = ball - cue, D = |d|^2 - 4 r^2:
///
///   disc = 4 r^2 |v|^2 - (d x v)^2          [= (d.v)^2 - |v|^2 D]
///   hit <=> d.v > 0, disc > eps (d.v)^2, 1 - mu s > eps_stop
///   s = D / (d.v + sqrt(disc)),  n = (d - v s) / (2 r),  a = sqrt(disc) / (2
///   r) y = ball + (1 + e) / (2 mu) (1 - mu s) a n;   miss: y = ball, bit for
///   bit
///
/// The cross-product form of disc keeps the digits that the other loses near
/// grazing. Tangency and arriving with zero speed are misses, by eps, eps_stop
/// = 1e-14, 1e-12 in double and 1e-6, 1e-6 in float.
///
/// Unknown x: velocity (2). Given: position of the other ball (2), apart from
/// the cue ball. Observation y: where the other ball comes to rest (2).
/// vjp, Jacobian: exact; exactly 0 for a miss (a plateau of the loss); of size
/// |v| / a, unbounded, towards grazing.
///
/// A velocity or position that is not finite gives NaN in its own column of y
/// and of the derivatives. Speeds whose square could overflow (3e147 in double,
/// 4e15 in float) or positions beyond 1e6 (1e3 in float) count as misses.
#pragma once

#include <array>

#include "suite/core/recipe.h"

namespace physinv {

struct BilliardsOptions {
  double radius = 0.2;                        ///< of both balls
  double elasticity = 0.8;                    ///< e: 0 inelastic, 1 elastic
  double drag = 0.4;                          ///< mu, per unit of time
  std::array<double, 2> cue = {0.0, 0.5};     ///< where the cue ball starts
  double ball_x = 1.0;                        ///< the other ball is at
  std::array<double, 2> ball_y = {0.0, 1.0};  ///< (ball_x, U(ball_y))
  std::array<double, 2> target = {2.0, 0.5};  ///< for the other ball
  std::array<double, 2> start = {1.0, 0.0};   ///< first guess of the velocity
  /// Labelled samples have velocity start + U(-spread, spread)^2.
  double velocity_spread = 0.5;

  auto fields() const {
    return std::tuple{field("radius", radius),
                      field("elasticity", elasticity),
                      field("drag", drag),
                      field("cue", cue),
                      field("ball_x", ball_x),
                      field("ball_y", ball_y),
                      field("target", target),
                      field("start", start),
                      field("velocity_spread", velocity_spread)};
  }
};

/// One collision, as the kernels see it.
template <class T>
struct Collision {
  bool hit = false;
  T s = 0, time = 0;  ///< travelled fraction, and the time it stands for
  std::array<T, 2> cue_at_contact{}, cue_velocity_before{};
  std::array<T, 2> normal{};  ///< unit, from the cue ball to the other
  T normal_speed = 0;         ///< of the cue ball, before
  std::array<T, 2> ball_velocity_after{}, cue_velocity_after{};
  std::array<T, 2> final_ball{};
};

/// The collision of one pair, through the same kernel as `Billiards<T>`.
/// Without a hit only `final_ball` is filled.
template <class T>
Collision<T> collide(const std::array<T, 2>& velocity,
                     const std::array<T, 2>& ball,
                     const BilliardsOptions& options = {});

/// What the event loop does, to its end.
struct BilliardsPath {
  int events = 0;  ///< collisions, at most 8
  std::array<double, 2> final_cue{}, final_ball{};
};

/// Advances to the next collision of the two balls, resolves it, and repeats
/// until none is left: the definition against which the kernels' single event
/// is checked. They skip the search after the first collision (the gap opens
/// and, both balls slowing in proportion, never closes) and the cue ball's
/// further way, which no observation contains.
BilliardsPath simulate_events(const std::array<double, 2>& velocity,
                              const std::array<double, 2>& ball,
                              const BilliardsOptions& options = {});

/// The only velocity that sends the ball to the target. For data, checks and
/// plots; no method may use it. With n = (target - ball) / l,
/// w = ball - 2 r n - cue, cos = n.w / |w|:
///   v = w / |w| (l / (c cos) + mu |w|),  c = (1 + e) / (2 mu).
/// The ball must lie between cue and target (cos > 0).
std::array<double, 2> exact_velocity(const std::array<double, 2>& ball,
                                     const BilliardsOptions& options = {});

namespace problems {
ProblemRecipe billiards(const BilliardsOptions& options = {});
}

}  // namespace physinv
