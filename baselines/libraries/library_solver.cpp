#include "library_solver.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <exception>
#include <utility>

#include "suite/core/check.h"

namespace libraries {
namespace {

using physinv::VectorIn;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// How often a library may swallow BudgetSpent.
constexpr int kTries = 20;

/// Points of a line search among which an iterate is looked for.
constexpr std::size_t kRemembered = 64;

bool finite(const double* x, Index d) {
  return std::all_of(x, x + d, [](double v) { return std::isfinite(v); });
}

/// Without bounds every point is; NaN is outside.
bool within(const Task& task, const double* x, Index d) {
  for (Index j = 0; !task.lower.empty() && j < d; ++j) {
    const auto at = static_cast<std::size_t>(j);
    if (!(x[j] >= task.lower[at] && x[j] <= task.upper[at])) return false;
  }
  return true;
}

/// The largest entry of the gradient, of what it would move within the bounds.
double left_of(const Task& task, VectorIn<double> x, Vector<double> gradient) {
  for (Index j = 0; !task.lower.empty() && j < x.size(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    const double moved =
        std::clamp(x(j) - gradient(j), task.lower[at], task.upper[at]);
    gradient(j) = x(j) - moved;
  }
  return gradient.cwiseAbs().maxCoeff();
}

bool same(const double* a, const double* b, Index d) {
  return std::memcmp(a, b, static_cast<std::size_t>(d) * sizeof(double)) == 0;
}

}  // namespace

/// One problem: what its library asked for last, and what it got.
struct LibrarySolver::Run final : Objective {
  struct Known {
    Vector<double> x;
    double loss;
    Vector<double> gradient;
    Point point() const { return {x.data(), loss, gradient.data()}; }
  };

  LibrarySolver& solver;
  Index i, d;
  std::deque<Known> known;  ///< the last is the last evaluated
  Vector<double> asked;
  double best = kNan;
  Index calls = 0, outside = 0;
  int refusals = 0;
  bool waits = false, spent = false, met_nonfinite = false, returned = false;
  LibraryEnd end;
  std::unique_ptr<Fiber> fiber;

  Run(LibrarySolver& s, Index problem, Index unknowns)
      : solver(s), i(problem), d(unknowns) {}

  double evaluate(const double* x, double* gradient) override;
  void iterate(const double* x) override {
    if (const Known* at = find(x)) solver.move_to(i, at->point());
  }
  void remember(const Point& at);
  const Known* find(const double* x) const;
  void run(const Library& library, Index iterations);
};

double LibrarySolver::Run::evaluate(const double* x, double* gradient) {
  if (++calls > solver.task_.evaluations) {
    spent = true;
    // One that still continues is not resumed any more.
    if (++refusals > kTries) fiber->suspend();
    throw BudgetSpent{};
  }
  if (!within(solver.task_, x, d)) ++outside;
  if (!finite(x, d)) {
    met_nonfinite = true;
    std::fill_n(gradient, d, kNan);
    return kNan;
  }
  if (!same(x, known.back().x.data(), d)) {
    asked = Eigen::Map<const Vector<double>>(x, d);
    waits = true;
    fiber->suspend();
  }
  const Known& last = known.back();
  std::copy_n(last.gradient.data(), d, gradient);
  return last.loss;
}

void LibrarySolver::Run::remember(const Point& at) {
  using Map = Eigen::Map<const Vector<double>>;
  if (known.size() >= kRemembered) known.pop_front();
  known.push_back({Map(at.x, d), at.loss, Map(at.gradient, d)});
  met_nonfinite =
      met_nonfinite || !std::isfinite(at.loss) || !finite(at.gradient, d);
  if (!(at.loss >= best)) best = std::isnan(at.loss) ? best : at.loss;
}

const LibrarySolver::Run::Known* LibrarySolver::Run::find(
    const double* x) const {
  const auto at = std::find_if(known.rbegin(), known.rend(), [&](auto& k) {
    return same(k.x.data(), x, d);
  });
  return at == known.rend() ? nullptr : &*at;
}

void LibrarySolver::Run::run(const Library& library, Index iterations) {
  const Vector<double> x0 = known.back().x;
  const auto failure = [&](std::string message) {
    end = {.x = {},
           .status = met_nonfinite ? Status::nonfinite : Status::linesearch,
           .message = std::move(message)};
  };
  try {
    end = library(*this, x0, iterations);
    returned = end.x.size() == d;
  } catch (const BudgetSpent&) {
  } catch (const std::exception& e) {
    failure(e.what());
  } catch (...) {
    failure("threw something other than a std::exception");
  }
  if (!spent) return;
  end.status = Status::maxiter, end.success = false;
  end.message = "budget of evaluations spent";
}

LibrarySolver::LibrarySolver(Library library, const Task& task)
    : IndependentSolver(KnownPoint::evaluate),
      library_(std::move(library)),
      task_(task) {
  SUITE_CHECK(task.iterations >= 0 && task.evaluations > 0,
              "iterations must not be negative, evaluations must be positive");
}

LibrarySolver::~LibrarySolver() = default;

void LibrarySolver::start(physinv::BatchIn<double> x0) {
  open(x0);
  runs_.clear();
  for (Index i = 0; i < x0.cols(); ++i)
    runs_.push_back(std::make_unique<Run>(*this, i, d_));
}

bool LibrarySolver::begin(Index i, double* trial) {
  Run& run = *runs_[static_cast<std::size_t>(i)];
  run.remember({x_.col(i).data(), loss_(i), gradient_.col(i).data()});
  run.fiber = std::make_unique<Fiber>(
      [this, &run](Fiber&) { run.run(library_, task_.iterations); });
  return go_on(i, trial);
}

bool LibrarySolver::advance(Index i, const Point& at, double* trial) {
  Run& run = *runs_[static_cast<std::size_t>(i)];
  run.remember(at);
  if (run.fiber == nullptr) return end(i, &at);
  return go_on(i, trial);
}

/// To the library's next evaluation, or to its end.
bool LibrarySolver::go_on(Index i, double* trial) {
  Run& run = *runs_[static_cast<std::size_t>(i)];
  run.waits = false;
  run.fiber->resume();
  if (run.waits) {
    std::copy_n(run.asked.data(), d_, trial);
    return true;
  }
  if (!run.fiber->done())
    run.end = {.message = "budget of evaluations spent, and went on"};
  run.fiber.reset();
  return conclude(i, trial);
}

/// Takes the point that the library returned, which is evaluated if it was not.
bool LibrarySolver::conclude(Index i, double* trial) {
  Run& run = *runs_[static_cast<std::size_t>(i)];
  if (!run.returned || is_iterate(i, run.end.x.data())) return end(i, nullptr);
  if (!finite(run.end.x.data(), d_)) {
    run.end.status = Status::nonfinite;
    return end(i, nullptr);
  }
  if (const Run::Known* at = run.find(run.end.x.data())) {
    const Point point = at->point();
    return end(i, &point);
  }
  std::copy_n(run.end.x.data(), d_, trial);
  return true;
}

bool LibrarySolver::end(Index i, const Point* at) {
  Run& run = *runs_[static_cast<std::size_t>(i)];
  run.known.clear();
  if (at != nullptr) {
    if (std::isfinite(at->loss))
      move_to(i, *at);
    else
      run.end.status = Status::nonfinite;
  }
  return finish(i, run.end.status);
}

/// Two moves in one round are one.
void LibrarySolver::move_to(Index i, const Point& at) {
  if (is_iterate(i, at.x)) return;
  const bool first = accepted_.empty() || accepted_.back() != i;
  accept(i, at);
  if (first) return;
  accepted_.pop_back();
  --iterations_[static_cast<std::size_t>(i)];
}

bool LibrarySolver::is_iterate(Index i, const double* x) const {
  return same(x, x_.col(i).data(), d_);
}

void LibrarySolver::report(physinv::Outcome& out) const {
  const auto n = static_cast<Index>(runs_.size());
  std::map<std::string, int> messages;
  const auto array = [&](const char* name, auto value) {
    physinv::Batch<double> values(1, n);
    for (Index i = 0; i < n; ++i)
      values(0, i) =
          static_cast<double>(value(i, *runs_[static_cast<std::size_t>(i)]));
    out.arrays[physinv::ArrayKey::own(name)] = std::move(values);
  };
  array("claims_success",
        [](Index, const Run& run) { return run.end.success; });
  array("returned_not_best",
        [&](Index i, const Run& run) { return loss_(i) > run.best; });
  array("false_loss", [&](Index i, const Run& run) {
    return run.returned && !std::isnan(run.end.loss) &&
           run.end.loss != loss_(i);
  });
  array("budget_spent", [](Index, const Run& run) { return run.spent; });
  if (!task_.lower.empty())
    array("outside_box", [](Index, const Run& run) { return run.outside; });
  array("gradient_left", [&](Index i, const Run&) {
    return left_of(task_, x_.col(i), gradient_.col(i));
  });
  for (const auto& run : runs_)
    if (!run->end.message.empty()) ++messages[run->end.message];
  std::vector<std::string> lines;
  for (const auto& [text, count] : messages)
    lines.push_back(fmt::format("{} x {}", count, text));
  out.message = fmt::format("{}", fmt::join(lines, "; "));
}

}  // namespace libraries
