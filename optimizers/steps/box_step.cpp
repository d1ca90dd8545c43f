#include "optimizers/steps/box_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimizers/steps/bfgs_update.h"

namespace physinv {

// ---- the bounds ------------------------------------------------------------

bool Box::bounds_any() const {
  for (Index i = 0; i < lower.size(); ++i)
    if (std::isfinite(lower(i)) || std::isfinite(upper(i))) return true;
  return false;
}

bool Box::bounds_all() const {
  for (Index i = 0; i < lower.size(); ++i)
    if (!std::isfinite(lower(i)) || !std::isfinite(upper(i))) return false;
  return true;
}

double Box::project(Index i, double value) const {
  return std::min(upper(i), std::max(lower(i), value));
}

double Box::gradient_norm(const double* x, const double* g) const {
  double norm = 0;
  for (Index i = 0; i < lower.size(); ++i) {
    const double inside = g[i] < 0 ? std::max(x[i] - upper(i), g[i])
                                   : std::min(x[i] - lower(i), g[i]);
    norm = std::max(norm, std::abs(inside));
  }
  return norm;
}

double Box::longest_step(const double* x,
                         const double* d,
                         double longest) const {
  for (Index i = 0; i < lower.size(); ++i) {
    if (d[i] == 0) continue;
    const double room = (d[i] < 0 ? lower(i) : upper(i)) - x[i];
    if (room == 0 || (room < 0) != (d[i] < 0)) return 0;
    if (std::abs(d[i]) * longest > std::abs(room)) longest = room / d[i];
  }
  return longest;
}

// ---- the generalized Cauchy point ------------------------------------------

void BoxStep::start(const Box& box, Index m) {
  const Index d = box.lower.size();
  box_ = &box;
  bounded_ = box.bounds_any();
  free_.assign(static_cast<std::size_t>(d), 1);
  breaks_.clear();
  breaks_.reserve(static_cast<std::size_t>(d));
  path_.resize(d);
  newton_.resize(d);
  for (Vector<double>* v : {&p_, &c_, &w_, &v_}) v->resize(2 * m);
}

bool BoxStep::aim(const double* x,
                  const double* g,
                  LimitedMemory& memory,
                  double* z) {
  if (bounded_ || memory.pairs() == 0) {
    cauchy_point(x, g, memory, z);
  } else {  // the subspace step starts from x
    std::copy(x, x + path_.size(), z);
    std::fill(free_.begin(), free_.end(), char{1});
  }
  return memory.pairs() == 0 || subspace_minimum(x, g, memory, z);
}

/// Direction and corners of the path, and which unknowns do not move at all.
void BoxStep::start_path(const double* x, const double* g) {
  breaks_.clear();
  path_ends_ = true;
  for (Index i = 0; i < path_.size(); ++i) {
    const double lower = box_->lower(i), upper = box_->upper(i);
    const bool held = lower == upper || (x[i] <= lower && g[i] >= 0) ||
                      (x[i] >= upper && g[i] <= 0);
    free_[static_cast<std::size_t>(i)] = held ? 0 : 1;
    path_(i) = held ? 0 : -g[i];
    if (path_(i) == 0) continue;
    const double room = path_(i) < 0 ? x[i] - lower : upper - x[i];
    if (std::isfinite(room)) {
      breaks_.push_back({room / std::abs(g[i]), i});
    } else {
      path_ends_ = false;
    }
  }
  std::sort(breaks_.begin(), breaks_.end(), [](const Break& a, const Break& b) {
    return a.t < b.t || (a.t == b.t && a.unknown < b.unknown);
  });
}

/// Walks the path from corner to corner; `slope` and `curvature` are those of
/// the model along the piece at hand.
void BoxStep::cauchy_point(const double* x,
                           const double* g,
                           const LimitedMemory& memory,
                           double* z) {
  const Index d = path_.size(), k = 2 * memory.pairs();
  const double theta = memory.theta();
  start_path(x, g);
  std::copy(x, x + d, z);
  std::fill(c_.data(), c_.data() + k, 0.0);
  double slope = -dense::dot(d, path_.data(), path_.data());
  if (slope == 0) return;
  double curvature = -theta * slope;
  const double least = std::numeric_limits<double>::epsilon() * curvature;
  memory.project(path_.data(), p_.data());
  memory.middle(p_.data(), v_.data());
  curvature -= dense::dot(k, v_.data(), p_.data());

  double ahead = -slope / curvature, before = 0, walked = 0;
  std::size_t corners = 0;
  for (const Break& corner : breaks_) {
    const double piece = corner.t - before;
    if (ahead < piece) break;
    ++corners;
    before = corner.t;
    walked += piece;
    const Index i = corner.unknown;
    const double move = path_(i);
    z[i] = move > 0 ? box_->upper(i) : box_->lower(i);
    free_[static_cast<std::size_t>(i)] = 0;
    path_(i) = 0;
    for (Index j = 0; j < k; ++j) dense::add_product(c_(j), piece, p_(j));
    if (corners == static_cast<std::size_t>(d)) return;  // all at a bound

    // The unknown's share of slope and curvature leaves.
    memory.row(i, w_.data());
    memory.middle(w_.data(), v_.data());
    slope = std::fma(piece, curvature, slope);
    slope = std::fma(move, move, slope);
    slope = std::fma(-theta * move, z[i] - x[i], slope);
    slope = std::fma(move, dense::dot(k, c_.data(), v_.data()), slope);
    curvature = std::fma(-theta * move, move, curvature);
    curvature =
        std::fma(2 * move, dense::dot(k, p_.data(), v_.data()), curvature);
    curvature =
        std::fma(-move * move, dense::dot(k, w_.data(), v_.data()), curvature);
    for (Index j = 0; j < k; ++j) dense::add_product(p_(j), -move, w_(j));
    curvature = std::max(least, curvature);
    ahead = -slope / curvature;
  }
  if (corners == breaks_.size() && path_ends_) ahead = 0;
  ahead = std::max(0.0, ahead);
  walked += ahead;
  for (Index i = 0; i < d; ++i) dense::add_product(z[i], walked, path_(i));
  for (Index j = 0; j < k; ++j) dense::add_product(c_(j), ahead, p_(j));
}

// ---- the subspace ----------------------------------------------------------

/// From the Cauchy point z by -(Z'BZ)^-1 Z'(g + B (z - x)).
bool BoxStep::subspace_minimum(const double* x,
                               const double* g,
                               LimitedMemory& memory,
                               double* z) {
  const Index d = path_.size();
  if (std::find(free_.begin(), free_.end(), 1) == free_.end()) return true;
  for (Index i = 0; i < d; ++i) newton_(i) = -g[i];
  if (bounded_) {
    for (Index i = 0; i < d; ++i)
      newton_(i) = std::fma(-memory.theta(), z[i] - x[i], newton_(i));
    memory.middle(c_.data(), v_.data());
    memory.expand(v_.data(), newton_.data());
    for (Index i = 0; i < d; ++i)
      if (free_[static_cast<std::size_t>(i)] == 0) newton_(i) = 0;
  }
  if (!memory.solve_free(free_, newton_.data())) return false;
  back_into_box(x, g, z);
  return true;
}

/// z + newton projected, unless that would lead uphill: then as far along
/// newton as the bounds allow.
void BoxStep::back_into_box(const double* x, const double* g, double* z) {
  const Index d = path_.size();
  bool met = false;
  double slope = 0;
  for (Index i = 0; i < d; ++i) {
    const double to = box_->project(i, z[i] + newton_(i));
    met |= newton_(i) != 0 && (to == box_->lower(i) || to == box_->upper(i));
    path_(i) = to;
    dense::add_product(slope, to - x[i], g[i]);
  }
  if (!met || slope <= 0) {
    std::copy(path_.data(), path_.data() + d, z);
    return;
  }
  const double alpha = box_->longest_step(z, newton_.data(), 1);
  for (Index i = 0; i < d; ++i) {
    const double step = newton_(i);
    const double bound = step > 0 ? box_->upper(i) : box_->lower(i);
    // The unknown that stops the step arrives at its bound to the last bit.
    const bool stops = alpha < 1 && step != 0 && (bound - z[i]) / step == alpha;
    z[i] = stops ? bound : std::fma(alpha, step, z[i]);
  }
}

}  // namespace physinv
