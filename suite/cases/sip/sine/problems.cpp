#include "suite/cases/sip/sine/problems.h"

#include <Eigen/LU>
#include <algorithm>
#include <functional>

#include "suite/core/any_problem.h"
#include "suite/store/record.h"

namespace physinv::sine {
namespace {

using Vector2 = Eigen::Vector2d;

Vector2 as_vector(const Pair& p) { return {p[0], p[1]}; }
Pair as_pair(const Vector2& v) { return {v(0), v(1)}; }

/// Slope of the loss along a step(x, y, gradient, Hessian).
using Step = std::function<Vector2(
    const Vector2&, const Vector2&, const Vector2&, const Eigen::Matrix2d&)>;

std::vector<double> slopes(const SinePlaneOptions& options,
                           const CaseData& data,
                           const Step& step) {
  const Index n = data.x.cols();
  Batch<double> x(2, n), y(2, n), g(2, n), h(4, n);
  for (Index i = 0; i < n; ++i) x.col(i) = data.x.col((i + 1) % n);
  const AnyProblem<double> problem(problems::sine_plane(options));
  Workspace work;
  Tape tape;
  problem.linearize(x, data.given, y, tape);
  problem.pullback(tape, y - data.y, g, work);
  problem.hessian(x, data.given, data.y, h, work);
  std::vector<double> all;
  for (Index i = 0; i < n; ++i) {
    const Vector2 to = data.y.col(i), from = x.col(i), gradient = g.col(i);
    const Eigen::Matrix2d hessian = h.col(i).reshaped(2, 2);
    all.push_back(gradient.dot(step(from, to, gradient, hessian)));
  }
  return all;
}

}  // namespace

RunValue solution_range() {
  return [](const Run& run) -> std::optional<double> {
    const Batch<double>& x = run.record->data.x;
    return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).maxCoeff();
  };
}

RunValue highest_slope(const SinePlaneOptions& options) {
  return [options](const Run& run) -> std::optional<double> {
    const auto all = slopes(
        options,
        run.record->data,
        [&](const Vector2& x, const Vector2& y, const auto&, const auto&) {
          return as_vector(
              limited_newton_step(options, as_pair(x), as_pair(y)));
        });
    return *std::max_element(all.begin(), all.end());
  };
}

RunValue newton_ascents(const SinePlaneOptions& options) {
  return [options](const Run& run) -> std::optional<double> {
    const auto all = slopes(options,
                            run.record->data,
                            [](const auto&, const auto&, auto& g, auto& h) {
                              return Vector2(-h.inverse() * g);
                            });
    return double(std::count_if(
               all.begin(), all.end(), [](double s) { return s > 0; })) /
           double(all.size());
  };
}

RunValue residual(const SinePlaneOptions& options) {
  return [options](const Run& run) -> std::optional<double> {
    const CaseData& data = run.record->data;
    Batch<double> x(2, data.y.cols()), y = x;
    for (Index i = 0; i < x.cols(); ++i) {
      const Pair at =
          nearest_solution(options, {0, 0}, {data.y(0, i), data.y(1, i)});
      x.col(i) << at[0], at[1];
    }
    Workspace work;
    AnyProblem<double>(problems::sine_plane(options))
        .forward(x, data.given, y, work);
    return (y - data.y).cwiseAbs().maxCoeff();
  };
}

RunValue share_beyond(double most) {
  return [most](const Run& run) -> std::optional<double> {
    const auto first = run.record->data.y.row(0).array().abs();
    return double((first > most).count()) / double(first.size());
  };
}

}  // namespace physinv::sine
