/// How a problem's loss looks over one or two of its unknowns.
#pragma once

#include <string>
#include <vector>

#include "suite/core/problem.h"
#include "suite/results/report_model.h"

namespace physinv {

/// What is observed, and its side input, a column of each.
struct Observed {
  Vector<double> y, given = {};
};

/// Of the points x, a column each.
Vector<double> losses_of(const Problem<double>& problem,
                         const Observed& observed,
                         BatchIn<double> x);

/// The loss of a problem of two unknowns over both, in decades.
Field2D loss_over_plane(const Problem<double>& problem,
                        const Observed& observed,
                        std::vector<double> first,
                        std::vector<double> second);

/// The axis along which a loss is drawn: `at` is scale * unknown, or that and
/// a constant.
struct LossAxis {
  std::string label;
  Vector<double> at;
  Index unknown = 0;
  double scale = 1;
};

/// One line in the style of a method.
Panel line_panel(std::string method,
                 std::string x_label,
                 std::string y_label,
                 const Vector<double>& x,
                 const Vector<double>& y);

/// The loss at the points x, a panel, and its derivative along the axis. The
/// problem has a Vjp.
std::vector<Panel> loss_and_derivative(const Problem<double>& problem,
                                       const Observed& observed,
                                       BatchIn<double> x,
                                       const LossAxis& axis,
                                       const std::string& method);

}  // namespace physinv
