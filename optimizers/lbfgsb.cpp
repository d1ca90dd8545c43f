#include "optimizers/lbfgsb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

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

}  // namespace

void Lbfgsb::set_box(Index d) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  box_ = {each(options_.lower, d, -kInf), each(options_.upper, d, kInf)};
  for (Index i = 0; i < d; ++i)
    SUITE_CHECK(box_.lower(i) <= box_.upper(i),
                fmt::format("unknown {}: lower bound {} above upper bound {}",
                            i,
                            box_.lower(i),
                            box_.upper(i)));
  bounded_ = box_.bounds_any();
  boxed_ = box_.bounds_all();
  aim_.start(box_, options_.memory);
}

void Lbfgsb::start(BatchIn<double> x0) {
  const Index n = x0.cols();
  const auto count = static_cast<std::size_t>(n);
  d_ = x0.rows();
  SUITE_CHECK(d_ > 0, "L-BFGS-B needs unknowns");
  SUITE_CHECK(options_.memory > 0,
              "L-BFGS-B needs a memory of 1 pair at least");
  set_box(d_);
  rounds_ = 0;
  skipped_ = 0;
  x_ = x0;
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < d_; ++i) x_(i, j) = box_.project(i, x_(i, j));
  trial_ = x_;
  gradient_.setZero(d_, n);
  target_.setZero(d_, n);
  direction_.setZero(d_, n);
  loss_.setConstant(n, std::numeric_limits<double>::quiet_NaN());
  step_.resize(d_);
  change_.resize(d_);
  problems_.resize(count);
  for (Problem& p : problems_) p.memory.start(d_, options_.memory);
  status_.assign(count, Status::maxiter);
  iterations_.assign(count, 0);
  evaluations_.assign(count, 0);
  accepted_.clear();
  accepted_.reserve(count);
  active_.resize(count);
  std::iota(active_.begin(), active_.end(), Index{0});
}

void Lbfgsb::supply(VectorIn<double> loss, BatchIn<double> gradient) {
  const auto m = static_cast<Index>(active_.size());
  SUITE_CHECK(loss.size() == m && gradient.cols() == m && gradient.rows() == d_,
              "one loss and one gradient per active problem");
  skipped_ += static_cast<std::uint64_t>(x_.cols() - m);
  accepted_.clear();
  std::size_t kept = 0;
  for (Index at = 0; at < m; ++at) {
    const Index i = active_[static_cast<std::size_t>(at)];
    // Never ahead of `at`: this column's point has been used by then.
    double* trial = trial_.col(static_cast<Index>(kept)).data();
    ++evaluations_[static_cast<std::size_t>(i)];
    const double* g = gradient.col(at).data();
    const bool goes_on = rounds_ == 0 ? begin(i, loss(at), g, trial)
                                      : advance(i, at, loss(at), g, trial);
    if (goes_on) active_[kept++] = i;
  }
  active_.resize(kept);
  ++rounds_;
}

bool Lbfgsb::begin(Index i,
                   double loss,
                   const double* gradient,
                   double* trial) {
  loss_(i) = loss;
  std::copy(gradient, gradient + d_, gradient_.col(i).data());
  if (!std::isfinite(loss) || !dense::all_finite(d_, gradient))
    return finish(i, Status::nonfinite);
  accepted_.push_back(i);
  if (box_.gradient_norm(x_.col(i).data(), gradient) <= options_.pgtol)
    return finish(i, Status::gtol);
  if (options_.maxiter <= 0) return finish(i, Status::maxiter);
  return iterate(i, trial);
}

/// An evaluation came back: one move of the line search, perhaps the last.
bool Lbfgsb::advance(
    Index i, Index at, double loss, const double* gradient, double* trial) {
  Problem& p = problems_[static_cast<std::size_t>(i)];
  const double slope = dense::dot(d_, gradient, direction_.col(i).data());
  const auto next = p.line.supply(search_options(p), loss, slope);
  if (next == LineSearch::Next::evaluate && point(i, trial)) return true;
  if (next != LineSearch::Next::accept) {
    const bool finite = std::isfinite(loss) && std::isfinite(slope);
    return restart(i, finite ? Status::linesearch : Status::nonfinite, trial);
  }

  const double loss_before = loss_(i);
  double* g = gradient_.col(i).data();
  for (Index j = 0; j < d_; ++j) change_(j) = gradient[j] - g[j];
  std::copy(gradient, gradient + d_, g);
  x_.col(i) = trial_.col(at);
  loss_(i) = loss;
  ++iterations_[static_cast<std::size_t>(i)];
  accepted_.push_back(i);
  if (done(i, loss_before)) return false;
  remember(i, slope);
  return iterate(i, trial);
}

/// The tests after an accepted step, in SciPy's order.
bool Lbfgsb::done(Index i, double loss_before) {
  const auto at = static_cast<std::size_t>(i);
  if (iterations_[at] >= options_.maxiter || evaluations_[at] > options_.maxfun)
    return !finish(i, Status::maxiter);
  const double scale =
      std::max({std::abs(loss_before), std::abs(loss_(i)), 1.0});
  const bool flat =
      box_.gradient_norm(x_.col(i).data(), gradient_.col(i).data()) <=
      options_.pgtol;
  if (flat || loss_before - loss_(i) <= options_.ftol * scale)
    return !finish(i, Status::gtol);
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

bool Lbfgsb::finish(Index i, Status status) {
  status_[static_cast<std::size_t>(i)] = status;
  return false;
}

}  // namespace physinv
