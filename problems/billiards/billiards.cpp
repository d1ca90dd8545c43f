#include "problems/billiards/billiards.h"

#include <cmath>
#include <limits>
#include <type_traits>

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"
#include "suite/core/simd/samples.h"

namespace physinv {
namespace {

using Place = std::array<double, 2>;

double reach(const BilliardsOptions& o) {
  return (1 + o.elasticity) / (2 * o.drag);
}

/// The options in the precision of the kernel, and its thresholds.
template <class T>
struct Constants {
  static constexpr bool kDouble = std::is_same_v<T, double>;
  static constexpr T kGrazing = kDouble ? T(1e-14) : T(1e-6);
  static constexpr T kStopping = kDouble ? T(1e-12) : T(1e-6);
  // |d| |v| squared stays finite; powers of two near 3e147 and 4e15.
  static constexpr T kFastest = kDouble ? T(0x1p490) : T(0x1p52f);
  static constexpr T kFarthest = kDouble ? T(0x1p20) : T(0x1p10f);

  explicit Constants(const BilliardsOptions& o)
      : cue{T(o.cue[0]), T(o.cue[1])},
        gap(T(2 * o.radius)),
        gap2(T(4 * o.radius * o.radius)),
        gap2_rest(T(4 * o.radius * o.radius - double(gap2))),
        per_gap(1 / gap),
        mu(T(o.drag)),
        c(T(reach(o))) {}

  // gap: distance of the centres at contact, 2 r; its square, what rounding
  // that to T left over (it matters near grazing in float), its reciprocal.
  T cue[2], gap, gap2, gap2_rest, per_gap, mu, c;
};

/// One block of samples at the moment of contact. Lanes that miss hold
/// harmless values: s = 0, a = 1.
template <class T>
struct Contact {
  Pack<T> v[2], n[2], s, a, keep;  // keep = 1 - mu s
  Pack<T> y[2];
  Mask<T> hit, broken;  // broken: some input is not finite
};

template <class T>
void find_contact(const Constants<T>& k,
                  const Pack<T> (&velocity)[2],
                  const Pack<T> (&ball)[2],
                  Contact<T>& out) {
  using P = Pack<T>;
  using K = Constants<T>;
  const P zero = P{} + T(0), one = P{} + T(1);
  const auto& [vx0, vy0] = velocity;
  const auto& [bx0, by0] = ball;
  const Mask<T> outside =
      beyond<T>(vx0, K::kFastest) | beyond<T>(vy0, K::kFastest) |
      beyond<T>(bx0, K::kFarthest) | beyond<T>(by0, K::kFarthest);
  out.broken = Mask<T>{};
  if (any(outside)) [[unlikely]] {
    constexpr T kMax = std::numeric_limits<T>::max();
    out.broken = beyond<T>(vx0, kMax) | beyond<T>(vy0, kMax) |
                 beyond<T>(bx0, kMax) | beyond<T>(by0, kMax);
  }

  const P vx = select(outside, zero, vx0), vy = select(outside, zero, vy0);
  const P bx = select(outside, zero, bx0), by = select(outside, zero, by0);
  const P dx = bx - k.cue[0], dy = by - k.cue[1];
  const P along = fma_lanes(dx, vx, dy * vy);
  const P across = fma_lanes(dx, vy, -(dy * vx));
  const P vv = fma_lanes(vx, vx, vy * vy);
  const P disc =
      fma_lanes(k.gap2_rest, vv, fma_lanes(-across, across, k.gap2 * vv));
  const Mask<T> meets = (along > zero) & (disc > K::kGrazing * (along * along));

  const P root = sqrt_lanes(select(meets, disc, one));
  const P s = fma_lanes(dx, dx, fma_lanes(dy, dy, -k.gap2 - zero)) /
              select(meets, along + root, one);
  out.hit = meets & (fma_lanes(-k.mu, s, one) > K::kStopping);

  out.s = select(out.hit, s, zero);
  out.a = select(out.hit, root * k.per_gap, one);
  out.keep = fma_lanes(-k.mu, out.s, one);
  out.v[0] = vx, out.v[1] = vy;
  out.n[0] = fma_lanes(-vx, out.s, dx) * k.per_gap;
  out.n[1] = fma_lanes(-vy, out.s, dy) * k.per_gap;
  const P way = k.c * (out.keep * out.a);
  const P nan = P{} + std::numeric_limits<T>::quiet_NaN();
  out.y[0] = select(out.hit, fma_lanes(way, out.n[0], bx), bx0);
  out.y[1] = select(out.hit, fma_lanes(way, out.n[1], by), by0);
  for (P& y : out.y) y = select(out.broken, nan, y);
}

/// j[r + 2 c] = d y_r / d v_c.
template <class T>
PHYSINV_LANES void differentiate(const Constants<T>& k,
                                 const Contact<T>& at,
                                 Pack<T>* j) {
  using P = Pack<T>;
  const P zero = P{} + T(0);
  const P nan = P{} + std::numeric_limits<T>::quiet_NaN();
  const P vv = fma_lanes(at.v[0], at.v[0], at.v[1] * at.v[1]);
  const P ratio = at.s / at.a, speed = at.keep * at.a;
  for (int c = 0; c < 2; ++c) {
    const P s_c = -ratio * at.n[c];
    const P along_c = fma_lanes(vv, s_c, at.s * at.v[c]);
    const P a_c = fma_lanes(-k.per_gap, along_c, at.n[c]);
    const P speed_c = fma_lanes(at.keep, a_c, -(k.mu * at.a * s_c));
    for (int r = 0; r < 2; ++r) {
      const P moved = at.v[r] * s_c;
      const P n_c = (r == c ? at.s + moved : moved) * -k.per_gap;
      const P full = k.c * fma_lanes(at.n[r], speed_c, speed * n_c);
      j[r + 2 * c] = select(at.broken, nan, select(at.hit, full, zero));
    }
  }
}

/// Runs body(constants, contact, block) for every block; returns the hits.
template <class T, class F>
PHYSINV_LANES Index for_contacts(const BilliardsOptions& options,
                                 const Point<T>& at,
                                 F&& body) {
  const Constants<T> k(options);
  const Index blocks = Lanes<T>::blocks(at.x.cols());
  Mask<T> hits{};
  for (Index b = 0; b < blocks; ++b) {
    Pack<T> v[2], ball[2];
    Lanes<T>(v, 2).load(at.x, b * kLanes<T>);
    Lanes<T>(ball, 2).load(at.given, b * kLanes<T>);
    Contact<T> contact;
    find_contact(k, v, ball, contact);
    hits += contact.hit;
    body(k, contact, b);
  }
  return count_set(hits);
}

template <class T>
void check_options(const BilliardsOptions& o) {
  check_numbers<T>({{"radius", o.radius},
                    {"elasticity", o.elasticity},
                    {"drag", o.drag},
                    {"cue", o.cue[0]},
                    {"cue", o.cue[1]},
                    {"ball_x", o.ball_x},
                    {"ball_y", o.ball_y[0]},
                    {"ball_y", o.ball_y[1]},
                    {"target", o.target[0]},
                    {"target", o.target[1]},
                    {"start", o.start[0]},
                    {"start", o.start[1]},
                    {"velocity_spread", o.velocity_spread}});
  SUITE_CHECK(o.radius > 0 && o.drag > 0, "radius and drag must be positive");
  SUITE_CHECK(o.elasticity >= 0 && o.elasticity <= 1,
              "elasticity must be in [0, 1]");
  SUITE_CHECK(std::abs(o.ball_x - o.cue[0]) > 2 * o.radius,
              "the balls must start apart");
  SUITE_CHECK(o.ball_y[0] <= o.ball_y[1] && o.velocity_spread >= 0,
              "ball_y must be a range, velocity_spread must not be negative");
}

/// Travelled fraction until two balls a distance d apart, of relative speed u,
/// touch; negative if they never do.
double next_contact(const Place& d, const Place& u, const BilliardsOptions& o) {
  using K = Constants<double>;
  const double gap = 2 * o.radius, along = d[0] * u[0] + d[1] * u[1];
  const double uu = u[0] * u[0] + u[1] * u[1];
  const double across = d[0] * u[1] - d[1] * u[0];
  const double disc = gap * gap * uu - across * across;
  if (!(along > 0) || !(disc > K::kGrazing * along * along)) return -1;
  const double s = (along - std::sqrt(disc)) / uu;
  return 1 - o.drag * s > K::kStopping ? s : -1;
}

enum Slot : std::size_t { kJacobians, kLive, kCount };

}  // namespace

template <class T>
Collision<T> collide(const std::array<T, 2>& velocity,
                     const std::array<T, 2>& ball,
                     const BilliardsOptions& o) {
  Pack<T> v[2]{}, b[2]{};
  for (int i = 0; i < 2; ++i) v[i][0] = velocity[i], b[i][0] = ball[i];
  const Constants<T> k(o);
  Contact<T> at;
  find_contact(k, v, b, at);
  Collision<T> out;
  out.hit = at.hit[0] != 0;
  out.final_ball = {at.y[0][0], at.y[1][0]};
  if (!out.hit) return out;
  out.s = at.s[0];
  out.time = -math::log1p(-k.mu * out.s) / k.mu;
  out.normal_speed = at.keep[0] * at.a[0];
  const T kick = T(0.5 * (1 + o.elasticity)) * out.normal_speed;
  for (int i = 0; i < 2; ++i) {
    out.cue_at_contact[i] = k.cue[i] + velocity[i] * out.s;
    out.cue_velocity_before[i] = velocity[i] * at.keep[0];
    out.normal[i] = at.n[i][0];
    out.ball_velocity_after[i] = kick * out.normal[i];
    out.cue_velocity_after[i] =
        out.cue_velocity_before[i] - kick * out.normal[i];
  }
  return out;
}

template decltype(collide<float>) collide<float>;
template decltype(collide<double>) collide<double>;

BilliardsPath simulate_events(const Place& velocity,
                              const Place& ball,
                              const BilliardsOptions& o) {
  Place p[2] = {o.cue, ball}, v[2] = {velocity, {0, 0}};
  BilliardsPath path;
  for (; path.events < 8; ++path.events) {
    const Place d = {p[1][0] - p[0][0], p[1][1] - p[0][1]};
    const double s = next_contact(d, {v[0][0] - v[1][0], v[0][1] - v[1][1]}, o);
    if (s < 0) break;
    for (int b = 0; b < 2; ++b)
      for (int i = 0; i < 2; ++i) {
        p[b][i] += v[b][i] * s;
        v[b][i] *= 1 - o.drag * s;
      }
    const Place n = {(p[1][0] - p[0][0]) / (2 * o.radius),
                     (p[1][1] - p[0][1]) / (2 * o.radius)};
    const double kick =
        0.5 * (1 + o.elasticity) *
        (n[0] * (v[0][0] - v[1][0]) + n[1] * (v[0][1] - v[1][1]));
    for (int i = 0; i < 2; ++i) {
      v[0][i] -= kick * n[i];
      v[1][i] += kick * n[i];
    }
  }
  for (int i = 0; i < 2; ++i) {
    path.final_cue[i] = p[0][i] + v[0][i] / o.drag;
    path.final_ball[i] = p[1][i] + v[1][i] / o.drag;
  }
  return path;
}

std::array<double, 2> exact_velocity(const Place& ball,
                                     const BilliardsOptions& o) {
  const double lx = o.target[0] - ball[0], ly = o.target[1] - ball[1];
  const double l = math::hypot(lx, ly);
  const Place n = {lx / l, ly / l};
  const Place w = {ball[0] - 2 * o.radius * n[0] - o.cue[0],
                   ball[1] - 2 * o.radius * n[1] - o.cue[1]};
  const double length = math::hypot(w[0], w[1]);
  const double cosine = (n[0] * w[0] + n[1] * w[1]) / length;
  const double speed = l / (reach(o) * cosine) + o.drag * length;
  return {w[0] / length * speed, w[1] / length * speed};
}

namespace {

template <class T>
class Billiards final : public Problem<T>, public Vjp<T>, public Jacobian<T> {
 public:
  explicit Billiards(const BilliardsOptions& options) : options_(options) {
    check_options<T>(options);
  }

  Shape shape() const override { return {2, 2, 2}; }
  Vector<double> start() const override {
    return Eigen::Vector2d(options_.start[0], options_.start[1]);
  }

  /// given = ball, y = target, x = exact velocity; of labelled samples
  /// x = start + U(-spread, spread)^2.
  void draw(Stream& stream, SampleOut& sample) const override {
    const Place ball = {options_.ball_x,
                        stream.uniform(options_.ball_y[0], options_.ball_y[1])};
    sample.given << ball[0], ball[1];
    const double spread = options_.velocity_spread;
    if (sample.labelled) {
      for (int j = 0; j < 2; ++j)
        sample.x(j) = options_.start[j] + stream.uniform(-spread, spread);
      return;
    }
    const Place v = exact_velocity(ball, options_);
    sample.y << options_.target[0], options_.target[1];
    sample.x << v[0], v[1];
  }
  Drawn drawn() const override { return Drawn::both; }

  /// Counts `skipped_events`: the searches and motions after a collision.
  void forward(Point<T> at, BatchOut<T> y, Workspace& work) const override {
    work.counts[Counter::skipped_events] += for_contacts<T>(
        options_, at, [&](const auto&, Contact<T>& contact, Index b) {
          Lanes<T>(contact.y, 2).store(y, b * kLanes<T>);
        });
  }
  /// Keeps the Jacobians in lanes; the tape counts `skipped_events`.
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    constexpr int W = kLanes<T>;
    const Index blocks = Lanes<T>::blocks(y.cols());
    auto jacobians = tape.slot<T>(kJacobians, 4 * W, blocks);
    auto live = tape.slot<LaneInt<T>>(kLive, W, blocks);
    tape.slot<Index>(kCount, 1, 1)(0, 0) = y.cols();
    auto* j = reinterpret_cast<Pack<T>*>(jacobians.data());
    auto* mask = reinterpret_cast<Mask<T>*>(live.data());
    tape.counts[Counter::skipped_events] += for_contacts<T>(
        options_, at, [&](const auto& k, Contact<T>& contact, Index b) {
          Lanes<T>(contact.y, 2).store(y, b * W);
          mask[b] = contact.hit | contact.broken;
          differentiate(k, contact, j + 4 * b);
        });
  }
  /// Counts `skipped_vjp`: the misses.
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    using P = Pack<T>;
    const Index count = tape.view<Index>(kCount)(0, 0);
    const auto jacobians = tape.view<T>(kJacobians);
    const auto live = tape.view<LaneInt<T>>(kLive);
    const auto* mask = reinterpret_cast<const Mask<T>*>(live.data());
    const auto* j = reinterpret_cast<const P*>(jacobians.data());
    Mask<T> computed{};
    for (Index b = 0; b < live.cols(); ++b, j += 4) {
      P g[2], out[2] = {};
      if (any(mask[b])) {
        Lanes<T>(g, 2).load(y_bar, b * kLanes<T>);
        // A miss ignores its cotangent, were it infinite: 0 * inf is not 0.
        for (P& row : g) row = select(mask[b], row, P{});
        out[0] = fma_lanes(j[0], g[0], j[1] * g[1]);
        out[1] = fma_lanes(j[2], g[0], j[3] * g[1]);
        computed += mask[b];
      }
      Lanes<T>(out, 2).store(x_bar, b * kLanes<T>);
    }
    // Padded lanes count as misses: take counts from the samples.
    work.counts[Counter::skipped_vjp] +=
        static_cast<std::uint64_t>(count - count_set(computed));
  }
  /// Rows of j: dy0/dx0, dy1/dx0, dy0/dx1, dy1/dx1.
  void jacobian(Point<T> at, BatchOut<T> j, Workspace& work) const override {
    work.counts[Counter::skipped_events] += for_contacts<T>(
        options_, at, [&](const auto& k, Contact<T>& contact, Index b) {
          Pack<T> lanes[4];
          differentiate(k, contact, lanes);
          Lanes<T>(lanes, 4).store(j, b * kLanes<T>);
        });
  }

  double operations() const override { return 45; }

 private:
  BilliardsOptions options_;
};

}  // namespace

ProblemRecipe problems::billiards(const BilliardsOptions& options) {
  return problem<Billiards>(
      "billiards",
      options,
      {.unknowns = {"v_x, v_y"}, .observations = {"x, y"}, .given = {"x, y"}});
}

}  // namespace physinv
