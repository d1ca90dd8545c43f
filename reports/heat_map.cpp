#include "reports/heat_map.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "reports/axis.h"
#include "reports/palette.h"
#include "reports/png.h"
#include "suite/core/math.h"
#include "suite/core/power_of_ten.h"

namespace physinv {
namespace {

constexpr std::size_t kMostCells = 512;  // a side
/// Pixels a side at least, several for a cell: some programs smooth pictures.
constexpr std::size_t kPixels = 256;

// Mean of what can be shown in a block of the grid; NaN if nothing.
double block_mean(const Field2D& f,
                  const Axis& scale,
                  std::size_t i0,
                  std::size_t i1,
                  std::size_t j0,
                  std::size_t j1) {
  double sum = 0;
  int count = 0;
  for (std::size_t j = j0; j < j1; ++j) {
    for (std::size_t i = i0; i < i1; ++i) {
      const double v = f.values[j * f.x.size() + i];
      if (!scale.shows(v)) continue;
      sum += f.log_scale ? math::log10(v) : v;
      ++count;
    }
  }
  const double mean = sum / count;
  return f.log_scale ? math::power_of_ten(mean) : mean;
}

Raster color_cells(const Field2D& f, const Axis& scale) {
  const std::size_t sx = 1 + (f.x.size() - 1) / kMostCells;
  const std::size_t sy = 1 + (f.y.size() - 1) / kMostCells;
  Raster cells{(f.x.size() + sx - 1) / sx, (f.y.size() + sy - 1) / sy, {}};
  for (std::size_t j = cells.height; j-- > 0;) {
    for (std::size_t i = 0; i < cells.width; ++i) {
      const double v = block_mean(f,
                                  scale,
                                  i * sx,
                                  std::min((i + 1) * sx, f.x.size()),
                                  j * sy,
                                  std::min((j + 1) * sy, f.y.size()));
      if (!scale.shows(v)) {
        cells.pixels.push_back(0);
        continue;
      }
      const double u = std::clamp(scale.place(v), 0.0, 1.0);
      const int color = static_cast<int>(u * kFieldColors);
      cells.pixels.push_back(
          static_cast<std::uint8_t>(1 + std::min(color, kFieldColors - 1)));
    }
  }
  return cells;
}

/// Every pixel as a block of `times` by `times`.
Raster enlarged(const Raster& cells, std::size_t times) {
  Raster out{cells.width * times, cells.height * times, {}};
  out.pixels.reserve(out.width * out.height);
  for (std::size_t j = 0; j < out.height; ++j)
    for (std::size_t i = 0; i < out.width; ++i)
      out.pixels.push_back(cells.pixels[j / times * cells.width + i / times]);
  return out;
}

void picture(
    Svg& svg, const Raster& raster, double x, double y, double w, double h) {
  svg.leaf("image",
           {{"x", svg_number(x)},
            {"y", svg_number(y)},
            {"width", svg_number(w)},
            {"height", svg_number(h)},
            {"preserveAspectRatio", "none"},
            {"style", "image-rendering:pixelated"},
            {"xmlns:xlink", "http://www.w3.org/1999/xlink"},
            {"xlink:href", data_url(png_of(raster, field_colors()))}});
}

void color_bar(Svg& svg,
               const Field2D& field,
               const Axis& scale,
               double x,
               double y,
               double h) {
  Raster colors{1, kFieldColors, {}};
  for (int k = kFieldColors; k > 0; --k)
    colors.pixels.push_back(static_cast<std::uint8_t>(k));
  picture(svg, enlarged(colors, kPixels / kFieldColors), x, y, 12, h);
  svg.rect("frame", x, y, 12, h);
  for (const Tick& t : scale.ticks(5)) {
    svg.text("tick", x + 16, y + h * (1 - scale.place(t.value)) + 4, t.label);
  }
  if (!field.label.empty()) {
    svg.text("tick", x, y - 10, field.label);
  }
}

}  // namespace

void draw_heat_map(
    Svg& svg, const Field2D& field, double x, double y, double w, double h) {
  if (field.values.size() != field.x.size() * field.y.size()) return;
  Axis scale(field.log_scale);
  for (const double v : field.values) scale.include(v);
  for (const auto& end : {field.min, field.max})
    if (end) scale.include(*end);
  scale.finish_tight();
  const Raster cells = color_cells(field, scale);
  const std::size_t times =
      1 + (kPixels - 1) / std::max(cells.width, cells.height);
  picture(svg, enlarged(cells, times), x, y, w, h);
  color_bar(svg, field, scale, x + w + 14, y, h);
}

}  // namespace physinv
