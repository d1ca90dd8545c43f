#include "suite/diagnostics/stability_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>

#include "suite/core/hash.h"
#include "suite/core/math.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/diagnostics/diagnostic.h"

namespace physinv {
namespace {

constexpr Index kSteps = 16;
constexpr double kWidest = 0.1, kNearby = 1e-7, kRatio = 4;
constexpr double kBeside = 1e-2;  ///< of a step, across its direction
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kSingleForward = 1e-3, kSingleAdjoint = 1e-2;
constexpr double kTangent = 1e-8, kDifferences = 1e-5;
/// Differences more uncertain than this decide nothing.
constexpr double kUseless = 1e-2;

/// Fixed, with no symmetry that could hide an error.
Vector<double> unit(Index rows, double shift) {
  return Vector<double>::NullaryExpr(
             rows, [=](Index i) { return math::cos(1.3 * double(i) + shift); })
      .normalized();
}

/// What one precision says at all points of one problem.
struct Side {
  Batch<double> y, x_bar;
};

template <class T>
Side evaluate(const ProblemRecipe& recipe,
              const Batch<double>& x,
              const Batch<double>& given,
              const Vector<double>& w,
              Threads* threads) {
  const auto problem = recipe.make<T>();
  const auto* vjp = dynamic_cast<const Vjp<T>*>(problem.get());
  Workspace work(threads);
  Tape tape;
  const Batch<T> points = x.cast<T>(), states = given.cast<T>();
  Batch<T> y(w.size(), x.cols()), x_bar(x.rows(), x.cols());
  vjp->linearize({points, states}, y, tape);
  vjp->pullback(tape, w.cast<T>().replicate(1, x.cols()).eval(), x_bar, work);
  return {y.template cast<double>(), x_bar.template cast<double>()};
}

/// d(k, j): central difference of w . F along v with the k-th step. Far from
/// the origin the points move by whole units of rounding only: what x_bar says
/// about the part across v is taken out, and a step that misses v gives NaN.
Batch<double> central_differences(const Problem<double>& problem,
                                  const Batch<double>& x,
                                  const Batch<double>& given,
                                  const Vector<double>& w,
                                  const Vector<double>& v,
                                  const Batch<double>& x_bar,
                                  double widest,
                                  Workspace& work) {
  Batch<double> d(kSteps, x.cols()), up = x, down = x;
  Batch<double> y_up(w.size(), x.cols()), y_down = y_up;
  double step = widest;
  for (Index k = 0; k < kSteps; ++k, step /= kRatio) {
    for (Index j = 0; j < x.cols(); ++j) {
      up.col(j) = x.col(j) + step * v;
      down.col(j) = x.col(j) - step * v;
    }
    problem.forward({up, given}, y_up, work);
    problem.forward({down, given}, y_down, work);
    for (Index j = 0; j < x.cols(); ++j) {
      const Vector<double> beside = (up - down).col(j) - 2 * step * v;
      const double change =
          (y_up - y_down).col(j).dot(w) - x_bar.col(j).dot(beside);
      const bool along = beside.norm() <= kBeside * 2 * step;
      d(k, j) = along ? change / (2 * step) : kNan;
    }
  }
  return d;
}

/// w . J v per column; J has the rows of y.
Vector<double> tangents(const Jacobian<double>& problem,
                        const Batch<double>& x,
                        const Batch<double>& given,
                        const Vector<double>& w,
                        const Vector<double>& v,
                        Workspace& work) {
  Batch<double> j(w.size() * x.rows(), x.cols());
  problem.jacobian({x, given}, j, work);
  Vector<double> out(x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    const Eigen::Map<const Batch<double>> of_one(
        j.col(i).data(), w.size(), x.rows());
    out(i) = w.dot(of_one * v);
  }
  return out;
}

struct Finding {
  SweepStatus status = SweepStatus::diverged;
  double error = -1;
};

Finding judge(double error, double tolerance) {
  if (!std::isfinite(error)) return {};
  return {error <= tolerance ? SweepStatus::ok : SweepStatus::inaccurate,
          error};
}

Finding judge_differences(const Extrapolated& d, double slope, double scale) {
  if (!d.found || !(d.uncertainty <= kUseless * scale))
    return {SweepStatus::undecided, -1};
  return judge(std::abs(d.value - slope) / scale,
               std::max(kDifferences, 4 * d.uncertainty / scale));
}

class StabilitySweep final : public Diagnostic {
 public:
  explicit StabilitySweep(StabilitySweepOptions options)
      : options_(std::move(options)) {}

  std::string name() const override { return options_.name; }
  Needs needs() const override { return Needs::forward | Needs::vjp; }
  double operations(const CaseSize&) const override {
    // Problems are made once, however many points they are looked at in.
    std::vector<double> points(options_.problems.size());
    for (const auto& point : options_.points)
      ++points[static_cast<std::size_t>(point.problem)];
    double sum = 0;
    for (std::size_t p = 0; p < points.size(); ++p)
      if (points[p] > 0)
        sum += points[p] * options_.problems[p].make<double>()->operations();
    return (4 * kSteps + 8) * static_cast<double>(options_.examples) * sum;
  }

 protected:
  std::string kind() const override { return "stability_sweep"; }
  std::vector<ProblemRecipe> problems() const override {
    return options_.problems;
  }
  /// Words of all points, which are many: made once.
  Options settings() const override {
    std::call_once(described_, [&] { settings_ = describe(options_); });
    return settings_;
  }

  void diagnose(StageRun& run, Outcome& out) const override {
    run.probe.begin();
    const auto columns =
        static_cast<Index>(options_.points.size()) * options_.examples;
    Batch<double> point = Batch<double>::Zero(kSweepRows, columns);
    Batch<double> status(kSweepChecks, columns), error(kSweepChecks, columns);
    Index first = 0, rows = 0;
    for (std::size_t p = 0; p < options_.problems.size(); ++p) {
      const Batch<double> x = points_of(static_cast<Index>(p));
      const Index count = x.cols(), kept = std::min(kSweepRows, x.rows());
      if (count == 0) continue;
      point.block(0, first, kept, count) = x.topRows(kept);
      rows = std::max(rows, kept);
      check(run,
            options_.problems[p],
            x,
            status.middleCols(first, count),
            error.middleCols(first, count));
      first += count;
    }
    point.conservativeResize(rows, columns);
    out.arrays = {{"point", point}, {"status", status}, {"error", error}};
  }

 private:
  /// Those of one problem, examples side by side.
  Batch<double> points_of(Index problem) const {
    std::vector<Vector<double>> xs;
    for (const auto& at : options_.points)
      if (at.problem == problem) xs.push_back(at.x());
    if (xs.empty()) return {};
    Batch<double> all(xs.front().size(),
                      static_cast<Index>(xs.size()) * options_.examples);
    for (Index j = 0; j < all.cols(); ++j)
      all.col(j) = xs[static_cast<std::size_t>(j / options_.examples)];
    return all;
  }

  void check(StageRun& run,
             const ProblemRecipe& recipe,
             const Batch<double>& x,
             BatchOut<double> status,
             BatchOut<double> error) const {
    const auto problem = recipe.make<double>();
    const Shape shape = problem->shape();
    const auto drawn = problem->sample(
        0, options_.examples, run.batches.child("stability_sweep"));
    const Batch<double> given =
        drawn.given.replicate(1, x.cols() / options_.examples);
    const Vector<double> w = unit(shape.observations, 0.4);
    const Vector<double> v = unit(shape.unknowns, 0.9);
    Workspace work(run.threads);
    const Side exact = evaluate<double>(recipe, x, given, w, run.threads);
    const Side single = evaluate<float>(recipe, x, given, w, run.threads);
    const std::vector<Finding> adjoint = by_differences(
        {*problem, x, given, w, v, exact.x_bar}, run.oracle, work);
    const auto* jacobian = dynamic_cast<const Jacobian<double>*>(problem.get());
    Vector<double> tangent;
    if (jacobian != nullptr)
      tangent = tangents(*jacobian, x, given, w, v, work);
    run.oracle.add(Counter::vjp, 2 * x.cols());

    for (Index j = 0; j < x.cols(); ++j) {
      std::array<Finding, kSweepChecks> found;
      if (exact.y.col(j).allFinite()) {
        found[0] = {SweepStatus::ok, 0};
        found[1] = judge(relative_distance(single.y.col(j), exact.y.col(j)),
                         kSingleForward);
        const double scale = std::max(options_.zero, exact.x_bar.col(j).norm());
        const double slope = exact.x_bar.col(j).dot(v);
        if (exact.x_bar.col(j).allFinite()) {
          found[2] = adjoint[static_cast<std::size_t>(j)];
          found[3] =
              jacobian == nullptr
                  ? Finding{SweepStatus::undecided, -1}
                  : judge(std::abs(tangent(j) - slope) / scale, kTangent);
          found[4] =
              judge((single.x_bar.col(j) - exact.x_bar.col(j)).norm() / scale,
                    kSingleAdjoint);
        }
      }
      for (Index c = 0; c < kSweepChecks; ++c) {
        const Finding& f = found[static_cast<std::size_t>(c)];
        status(c, j) = static_cast<double>(f.status);
        error(c, j) = f.error;
      }
    }
  }

  /// Adjoints at points x, and the directions that they are checked along.
  struct Adjoints {
    const Problem<double>& problem;
    const Batch<double>&x, &given;
    const Vector<double>&w, &v;
    const Batch<double>& x_bar;
  };

  /// The adjoints against central differences; where wide steps object, nearer
  /// ones decide if they can.
  std::vector<Finding> by_differences(const Adjoints& at,
                                      Oracle& oracle,
                                      Workspace& work) const {
    const auto judged = [&](const std::vector<Index>& some, double widest) {
      const Batch<double> d = central_differences(at.problem,
                                                  at.x(Eigen::all, some),
                                                  at.given(Eigen::all, some),
                                                  at.w,
                                                  at.v,
                                                  at.x_bar(Eigen::all, some),
                                                  widest,
                                                  work);
      oracle.add(Counter::forward, 2 * kSteps * d.cols());
      std::vector<Finding> found;
      for (Index k = 0; k < d.cols(); ++k) {
        const auto bar = at.x_bar.col(some[static_cast<std::size_t>(k)]);
        found.push_back(judge_differences(extrapolate(d.col(k)),
                                          bar.dot(at.v),
                                          std::max(options_.zero, bar.norm())));
      }
      return found;
    };
    std::vector<Index> all(static_cast<std::size_t>(at.x.cols())), doubtful;
    std::iota(all.begin(), all.end(), Index{0});
    std::vector<Finding> adjoint = judged(all, kWidest);
    for (const Index j : all)
      if (adjoint[static_cast<std::size_t>(j)].status != SweepStatus::ok)
        doubtful.push_back(j);
    const auto nearby = judged(doubtful, kNearby);
    for (std::size_t k = 0; k < doubtful.size(); ++k)
      if (nearby[k].status != SweepStatus::undecided)
        adjoint[static_cast<std::size_t>(doubtful[k])] = nearby[k];
    return adjoint;
  }

  StabilitySweepOptions options_;
  mutable std::once_flag described_;
  mutable Options settings_;
};

}  // namespace

Extrapolated extrapolate(VectorIn<double> d) {
  Extrapolated best;
  double least = kInf;  // relative, as too wide a step gives small values
  const auto refined = [&](Index k) {
    constexpr double kGain = kRatio * kRatio;
    return (kGain * d(k) - d(k - 1)) / (kGain - 1);
  };
  for (Index k = 3; k < d.size(); ++k) {
    const double value = refined(k - 1);
    const double before = std::abs(value - refined(k - 2));
    const double after = std::abs(refined(k) - value);
    const double change = before < after ? after : before;
    const double relative = change > 0 ? change / std::abs(value) : change;
    if (!(relative < least)) continue;  // also where not finite
    least = relative;
    best = {.value = value, .uncertainty = change, .found = true};
  }
  return best;
}

std::string fingerprint(const std::vector<SweepPoint>& points) {
  std::uint64_t hash = 0;
  for (const auto& [problem, at] : points) {
    const Vector<double> x = at();
    hash = hash_bytes(&problem, sizeof(problem), hash);
    hash = hash_bytes(
        x.data(), sizeof(double) * static_cast<std::size_t>(x.size()), hash);
  }
  return fmt::format("{} {}", points.size(), hex64(hash));
}

std::shared_ptr<const Stage> stability_sweep(StabilitySweepOptions options) {
  return std::make_shared<StabilitySweep>(std::move(options));
}

}  // namespace physinv
