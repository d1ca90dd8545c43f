#include "optimizers/lbfgsb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimizers/steps/bfgs_update.h"
#include "suite/core/check.h"

namespace physinv {
namespace {

Vector<double> each(const std::vector<double>& given, Index d, double none) {
  if (given.empty()) return Vector<double>::Constant(d, none);
  if (given.size() == 1) return Vector<double>::Constant(d, given[0]);
  SUITE_CHECK(static_cast<Index>(given.size()) == d,
              fmt::format("{} bounds for {} unknowns; give one for each, or "
                          "one for all",
                          given.size(),
                          d));
  return Eigen::Map<const Vector<double>>(given.data(), d);
}

void check(const LbfgsbOptions& o) {
  SUITE_CHECK(o.memory > 0, "L-BFGS-B: memory must be at least 1");
  SUITE_CHECK(o.pgtol >= 0 && o.ftol >= 0 && o.maxiter >= 0 && o.maxfun >= 0,
              "L-BFGS-B: pgtol, ftol, maxiter and maxfun must not be negative");
  SUITE_CHECK(o.maxls > 0, "L-BFGS-B: maxls must be positive");
}

}  // namespace

void Lbfgsb::set_box(Index d) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  box_ = {each(options_.lower, d, -kInf), each(options_.upper, d, kInf)};
  for (Index i = 0; i < d; ++i)
    SUITE_CHECK(box_.lower(i) <= box_.upper(i) && box_.lower(i) < kInf &&
                    box_.upper(i) > -kInf,
                fmt::format("unknown {}: no number lies between the bounds {} "
                            "and {}; give -inf and inf for no bounds",
                            i,
                            box_.lower(i),
                            box_.upper(i)));
  bounded_ = box_.bounds_any();
  boxed_ = box_.bounds_all();
  aim_.start(box_, options_.memory);
}

void Lbfgsb::start(BatchIn<double> x0) {
  check(options_);
  open(x0);
  set_box(d_);
  for (std::size_t at = 0; at < active_.size(); ++at) {
    const Index j = active_[at];
    for (Index i = 0; i < d_; ++i) x_(i, j) = box_.project(i, x_(i, j));
    trial_.col(static_cast<Index>(at)) = x_.col(j);
  }
  const Index n = x0.cols();
  target_.setZero(d_, n);
  direction_.setZero(d_, n);
  step_.resize(d_);
  change_.resize(d_);
  problems_.resize(static_cast<std::size_t>(n));
  for (Problem& p : problems_) p.memory.start(d_, options_.memory);
}

bool Lbfgsb::begin(Index i, double* trial) {
  if (box_.gradient_norm(x_.col(i).data(), gradient_.col(i).data()) <=
      options_.pgtol)
    return finish(i, Status::gtol);
  if (options_.maxiter <= 0) return finish(i, Status::maxiter);
  return iterate(i, trial);
}

/// One move of the line search, perhaps the last.
bool Lbfgsb::advance(Index i, const Point& at, double* trial) {
  Problem& p = problems_[static_cast<std::size_t>(i)];
  const double slope = dense::dot(d_, at.gradient, direction_.col(i).data());
  const auto next = p.line.supply(search_options(p), at.loss, slope);
  if (next == LineSearch::Next::evaluate && point(i, trial)) return true;
  if (next != LineSearch::Next::accept) {
    const bool finite = std::isfinite(at.loss) && std::isfinite(slope);
    return restart(i, finite ? Status::linesearch : Status::nonfinite, trial);
  }

  const double loss_before = loss_(i);
  const double* g = gradient_.col(i).data();
  for (Index j = 0; j < d_; ++j) change_(j) = at.gradient[j] - g[j];
  const bool moved = !std::equal(at.x, at.x + d_, x_.col(i).data());
  accept(i, at);
  if (done(i, loss_before, moved)) return false;
  remember(i, slope);
  return iterate(i, trial);
}

/// The tests after an accepted step, in SciPy's order.
bool Lbfgsb::done(Index i, double loss_before, bool moved) {
  const auto at = static_cast<std::size_t>(i);
  if (iterations_[at] >= options_.maxiter || evaluations_[at] > options_.maxfun)
    return !finish(i, Status::maxiter);
  const double scale =
      std::max({std::abs(loss_before), std::abs(loss_(i)), 1.0});
  if (box_.gradient_norm(x_.col(i).data(), gradient_.col(i).data()) <=
      options_.pgtol)
    return !finish(i, Status::gtol);
  if (loss_before - loss_(i) <= options_.ftol * scale)
    return !finish(i, moved ? Status::ftol : Status::linesearch);
  return false;
}

/// The step and `change_` enter the memory unless curvature is lost in
/// rounding.
void Lbfgsb::remember(Index i, double slope) {
  Problem& p = problems_[static_cast<std::size_t>(i)];
  const double step = p.line.step();
  const double curvature = (slope - p.slope) * step;
  if (curvature <= std::numeric_limits<double>::epsilon() * -p.slope * step)
    return;
  for (Index j = 0; j < d_; ++j) step_(j) = step * direction_(j, i);
  p.memory.update(step_.data(), change_.data(), curvature);
}

/// Starts the next iteration: target, direction, first trial point.
bool Lbfgsb::iterate(Index i, double* trial) {
  Problem& p = problems_[static_cast<std::size_t>(i)];
  const double* x = x_.col(i).data();
  const double* g = gradient_.col(i).data();
  double* z = target_.col(i).data();
  if (!aim_.aim(x, g, p.memory, z)) {
    p.memory.clear();
    aim_.aim(x, g, p.memory, z);
  }
  double* d = direction_.col(i).data();
  for (Index j = 0; j < d_; ++j) d[j] = z[j] - x[j];
  return start_search(i) && point(i, trial)
             ? true
             : restart(i, Status::linesearch, trial);
}

bool Lbfgsb::start_search(Index i) {
  Problem& p = problems_[static_cast<std::size_t>(i)];
  const double* d = direction_.col(i).data();
  const bool at_start = iterations_[static_cast<std::size_t>(i)] == 0;
  p.slope = dense::dot(d_, gradient_.col(i).data(), d);
  p.longest = 1e10;
  if (bounded_)
    p.longest = at_start ? 1.0 : box_.longest_step(x_.col(i).data(), d, 1e10);
  const double first = at_start && !boxed_ ? 1 / dense::norm(d_, d) : 1.0;
  return p.line.start(search_options(p),
                      loss_(i),
                      p.slope,
                      std::min(first, p.longest)) == LineSearch::Next::evaluate;
}

/// After a search without a step: once more without memory.
bool Lbfgsb::restart(Index i, Status otherwise, double* trial) {
  Problem& p = problems_[static_cast<std::size_t>(i)];
  if (p.memory.pairs() == 0) return finish(i, otherwise);
  p.memory.clear();
  return iterate(i, trial);
}

/// Writes the point of the search; false if it overflows, which is never shown
/// to the objective.
bool Lbfgsb::point(Index i, double* trial) const {
  const double step = problems_[static_cast<std::size_t>(i)].line.step();
  for (Index j = 0; j < d_; ++j)
    trial[j] =
        step == 1 ? target_(j, i) : std::fma(step, direction_(j, i), x_(j, i));
  return dense::all_finite(d_, trial);
}

LineSearchOptions Lbfgsb::search_options(const Problem& problem) const {
  return {.decrease = 1e-3,
          .curvature = 0.9,
          .xtol = 0.1,
          .min_step = 0,
          .max_step = problem.longest,
          .max_evaluations = options_.maxls,
          .search_1_only = true};
}

}  // namespace physinv
