/// Fields of two coordinates as panels of a figure.
#pragma once

#include <span>
#include <string>

#include "suite/core/batch.h"
#include "suite/results/report_model.h"

namespace physinv {

/// How a field lies in memory, and where its cells are: cell (i, j), i to the
/// right, is number i * x_stride + j * y_stride, its middle at
/// (x0 + (i + 1/2) size, y0 + (j + 1/2) size).
struct FieldLayout {
  Index nx, ny, x_stride, y_stride;
  double size = 1, x0 = 0, y0 = 0;
};

/// The field, a pixel a cell, as a place: its cells are squares.
Panel field_panel(std::string title,
                  const FieldLayout& layout,
                  const Vector<double>&);

/// The speed of a flow (u, v), with arrows of every `every`-th cell.
Panel flow_panel(std::string title,
                 const FieldLayout& layout,
                 const Vector<double>& u,
                 const Vector<double>& v,
                 Index every);

/// All fields with the scale that shows the largest of them.
void share_scale(std::span<Panel> panels);

}  // namespace physinv
