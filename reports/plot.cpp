#include "reports/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "reports/legend.h"
#include "reports/palette.h"
#include "reports/panel.h"
#include "reports/svg.h"
#include "reports/text.h"

namespace physinv {
namespace {

constexpr double kMargin = 16, kTitleLine = 20, kLegendLine = 20,
                 kNoteLine = 15;

struct Key {
  const Series* series;
  double x = 0, y = 0;
};

std::vector<Key> legend_keys(const Figure& figure) {
  std::vector<Key> keys;
  for (const Series* s : legend_of(figure)) keys.push_back({s});
  return keys;
}

// Places the entries in rows; returns the height used.
double lay_out(std::vector<Key>& keys, double width) {
  double x = 0, y = 0;
  for (Key& key : keys) {
    const double need =
        36 + 6.6 * static_cast<double>(display_width(key.series->label)) + 18;
    if (x > 0 && x + need > width) x = 0, y += kLegendLine;
    key.x = x, key.y = y;
    x += need;
  }
  return keys.empty() ? 0 : y + kLegendLine;
}

void draw_key(Svg& svg, const Key& key, Palette& palette, double x, double y) {
  const double left = x + key.x, mid = y + key.y + 10;
  draw_sample(svg, *key.series, palette.of(*key.series), left, mid);
  svg.text("label", left + 35, mid + 4, key.series->label);
}

struct Grid {
  int columns = 1, rows = 1;
  double cell_w = 0, cell_h = 0;
};

Grid grid_of(const Figure& figure) {
  const int count = std::max(1, static_cast<int>(figure.panels.size()));
  Grid grid;
  grid.columns = std::clamp(figure.columns, 1, count);
  grid.rows = (count + grid.columns - 1) / grid.columns;
  grid.cell_w = grid.columns == 1 ? 640 : grid.columns == 2 ? 420 : 330;
  grid.cell_h = grid.columns == 1 ? 380 : grid.columns == 2 ? 300 : 260;
  return grid;
}

std::string describe(const Figure& figure) {
  std::string text = figure.where;
  for (const Panel& p : figure.panels) {
    text += fmt::format("{}{}: {} over {}",
                        text.empty() ? "" : "; ",
                        p.title.empty() ? "panel" : p.title,
                        p.y_label,
                        p.x_label);
  }
  return text;
}

}  // namespace

std::string render_svg(const Figure& figure, const Palette& report) {
  Palette palette = palette_of(figure, report);
  Grid grid = grid_of(figure);
  double highest = 0;
  for (const Panel& panel : figure.panels)
    highest = std::max(
        highest,
        PanelPlot(panel, "", palette).height(grid.cell_w, grid.cell_h));
  if (highest > 0) grid.cell_h = highest;
  const double inner = grid.columns * grid.cell_w;
  const auto chars = [&](double each) {
    return static_cast<std::size_t>(inner / each);
  };
  const std::string head =
      figure.where.empty() ? figure.title : figure.where + " · " + figure.title;
  const auto title = wrap(head, chars(8.2));
  const std::string undrawn = undrawn_text(figure);
  const std::string both = figure.note +
                           (figure.note.empty() || undrawn.empty() ? "" : " ") +
                           undrawn;
  const auto note = wrap(both, chars(5.9));
  std::vector<Key> keys = legend_keys(figure);
  const double legend = lay_out(keys, inner);

  const double legend_y =
      kMargin + kTitleLine * static_cast<double>(title.size());
  const double panels_y = legend_y + legend + 8;
  const double note_y = panels_y + grid.rows * grid.cell_h + 4;
  const double height =
      note_y + kNoteLine * static_cast<double>(note.size()) + kMargin / 2;
  const double width = inner + 2 * kMargin;

  Svg svg(width, height, figure.title, describe(figure), style_sheet());
  svg.rect("bg", 0, 0, width, height);
  for (std::size_t i = 0; i < title.size(); ++i) {
    const double y = kMargin + 12 + kTitleLine * static_cast<double>(i);
    svg.text("title", kMargin, y, title[i]);
  }
  for (const Key& key : keys) draw_key(svg, key, palette, kMargin, legend_y);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const int row = static_cast<int>(i) / grid.columns;
    const int column = static_cast<int>(i) % grid.columns;
    const PanelPlot plot(
        figure.panels[i], fmt::format("{}-{}", figure.id, i), palette);
    plot.draw(svg,
              {kMargin + column * grid.cell_w,
               panels_y + row * grid.cell_h,
               grid.cell_w,
               grid.cell_h});
  }
  if (figure.panels.empty()) {
    svg.text("label",
             width / 2,
             panels_y + grid.cell_h / 2,
             figure.picture ? "nothing to draw" : "not run",
             "middle");
  }
  for (std::size_t i = 0; i < note.size(); ++i) {
    const double y = note_y + 10 + kNoteLine * static_cast<double>(i);
    svg.text("note", kMargin, y, note[i]);
  }
  return std::move(svg).str();
}

std::string render_card(const Figure& figure, const Palette& report) {
  constexpr double kLeast = 170;  // of the panel below a long legend
  Palette palette = palette_of(figure, report);
  std::vector<Key> keys = legend_keys(figure);
  const double legend = lay_out(keys, kCardWidth);
  const std::size_t count = figure.panels.size();
  const double width = kCardWidth / static_cast<double>(count);
  const double least =
      count == 1 ? std::max(kLeast, kCardHeight - legend) : kLeast;
  std::vector<PanelPlot> plots;
  double highest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    plots.emplace_back(figure.panels[i],
                       i == 0 ? figure.id : fmt::format("{}-{}", figure.id, i),
                       palette);
    highest = std::max(highest, plots.back().height(width, least));
  }
  Svg svg(kCardWidth,
          legend + highest,
          figure.title,
          describe(figure),
          style_sheet());
  for (const Key& key : keys) draw_key(svg, key, palette, 0, 0);
  for (std::size_t i = 0; i < count; ++i)
    plots[i].draw(svg,
                  {width * static_cast<double>(i), legend, width, highest});
  return std::move(svg).str();
}

}  // namespace physinv
