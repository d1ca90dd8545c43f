#include "suite/evidence/landscape.h"

#include <utility>

namespace physinv {
namespace {

/// The same observation for so many points.
struct Repeated {
  Repeated(const Observed& observed, Index points)
      : y(observed.y.replicate(1, points)),
        given(observed.given.replicate(1, points)) {}

  Batch<double> y, given;
};

}  // namespace

Vector<double> losses_of(const Problem<double>& problem,
                         const Observed& observed,
                         BatchIn<double> x) {
  const Repeated target(observed, x.cols());
  Batch<double> y(observed.y.size(), x.cols());
  Vector<double> loss(x.cols());
  Workspace work;
  problem.forward({x, target.given}, y, work);
  problem.loss(y, target.y, loss);
  return loss;
}

Field2D loss_over_plane(const Problem<double>& problem,
                        const Observed& observed,
                        std::vector<double> first,
                        std::vector<double> second) {
  Batch<double> x(2, static_cast<Index>(first.size() * second.size()));
  Index point = 0;
  for (const double b : second)
    for (const double a : first) x.col(point++) << a, b;
  const Vector<double> loss = losses_of(problem, observed, x);
  return {.x = std::move(first),
          .y = std::move(second),
          .values = {loss.begin(), loss.end()},
          .log_scale = true,
          .label = "loss"};
}

Panel line_panel(std::string method,
                 std::string x_label,
                 std::string y_label,
                 const Vector<double>& x,
                 const Vector<double>& y) {
  return {.x_label = std::move(x_label),
          .y_label = std::move(y_label),
          .series = {{.method = std::move(method),
                      .x = {x.begin(), x.end()},
                      .y = {y.begin(), y.end()}}}};
}

std::vector<Panel> loss_and_derivative(const Problem<double>& problem,
                                       const Observed& observed,
                                       BatchIn<double> x,
                                       const LossAxis& axis,
                                       const std::string& method) {
  const auto& derivative = dynamic_cast<const Vjp<double>&>(problem);
  const Repeated target(observed, x.cols());
  Batch<double> y(observed.y.size(), x.cols()), y_bar = y, x_bar = x;
  Vector<double> loss(x.cols());
  Tape tape;
  Workspace work;
  derivative.linearize({x, target.given}, y, tape);
  problem.loss(y, target.y, loss);
  problem.loss_gradient(y, target.y, y_bar);
  derivative.pullback(tape, y_bar, x_bar, work);
  return {line_panel(method, axis.label, "loss", axis.at, loss),
          line_panel(method,
                     axis.label,
                     "derivative of the loss",
                     axis.at,
                     x_bar.row(axis.unknown) / axis.scale)};
}

}  // namespace physinv
