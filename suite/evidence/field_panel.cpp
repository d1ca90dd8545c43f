#include "suite/evidence/field_panel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "suite/core/math.h"

namespace physinv {
namespace {

/// Middle of a row's or column's k-th cell.
double middle(const FieldLayout& layout, double from, Index k) {
  return from + (double(k) + 0.5) * layout.size;
}

}  // namespace

Panel field_panel(std::string title,
                  const FieldLayout& layout,
                  const Vector<double>& f) {
  Field2D field;
  for (Index i = 0; i < layout.nx; ++i)
    field.x.push_back(middle(layout, layout.x0, i));
  for (Index j = 0; j < layout.ny; ++j) {
    field.y.push_back(middle(layout, layout.y0, j));
    for (Index i = 0; i < layout.nx; ++i)
      field.values.push_back(f(i * layout.x_stride + j * layout.y_stride));
  }
  return {.title = std::move(title), .field = std::move(field), .space = true};
}

Panel flow_panel(std::string title,
                 const FieldLayout& layout,
                 const Vector<double>& u,
                 const Vector<double>& v,
                 Index every) {
  Panel panel = field_panel(
      std::move(title), layout, u.binaryExpr(v, [](double a, double b) {
        return math::hypot(a, b);
      }));
  Arrows arrows{.length = 1.4 * double(every) * layout.size};
  for (Index j = every / 2; j < layout.ny; j += every)
    for (Index i = every / 2; i < layout.nx; i += every) {
      const Index at = i * layout.x_stride + j * layout.y_stride;
      arrows.x.push_back(middle(layout, layout.x0, i));
      arrows.y.push_back(middle(layout, layout.y0, j));
      arrows.u.push_back(u(at)), arrows.v.push_back(v(at));
    }
  panel.arrows = std::move(arrows);
  return panel;
}

void share_scale(std::span<Panel> panels) {
  std::optional<double> least, most;
  for (const Panel& panel : panels) {
    if (!panel.field) continue;
    for (const double value : panel.field->values) {
      if (!std::isfinite(value)) continue;
      least = std::min(least.value_or(value), value);
      most = std::max(most.value_or(value), value);
    }
  }
  for (Panel& panel : panels)
    if (panel.field) panel.field->min = least, panel.field->max = most;
}

}  // namespace physinv
