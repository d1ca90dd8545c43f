#include <fmt/format.h>

#include <algorithm>

#include "reports/html_parts.h"
#include "reports/legend.h"
#include "reports/panel.h"
#include "reports/svg.h"

namespace physinv {
namespace {

struct Size {
  double w = 0, h = 0;
};

Size panel_size(int columns) {
  switch (columns) {
    case 1:
      return {560, 330};
    case 2:
      return {430, 290};
    case 3:
      return {330, 250};
    default:
      return {270, 215};
  }
}

std::string legend_html(const std::vector<const Series*>& legend,
                        Palette& palette) {
  if (legend.empty()) return "";
  std::string out = "<ul class=\"legend\">\n";
  for (std::size_t k = 0; k < legend.size(); ++k) {
    Svg sample = Svg::ornament(30, 12);
    draw_sample(sample, *legend[k], palette.of(*legend[k]), 1, 6);
    out += fmt::format("<li data-k=\"{}\">{}{}</li>\n",
                       k,
                       std::move(sample).str(),
                       html(legend[k]->label));
  }
  return out + "</ul>\n";
}

std::string panel_html(const Panel& panel,
                       const Figure& figure,
                       const std::string& id,
                       const std::vector<const Series*>& legend,
                       Palette& palette) {
  const Size size = panel_size(figure.columns);
  const std::string& name = panel.title.empty() ? figure.title : panel.title;
  Svg svg =
      Svg::inlined(size.w,
                   size.h,
                   name,
                   fmt::format("{} over {}", panel.y_label, panel.x_label));
  PanelPlot plot(panel, id, palette);
  std::vector<int> keys;
  for (const Series& s : panel.series) keys.push_back(legend_index(legend, s));
  plot.set_keys(std::move(keys));
  plot.draw(svg, {0, 0, size.w, size.h});
  return std::move(svg).str();
}

/// Panels without a point are words: which they are, or that none was run. The
/// moments of a film stay together.
std::string panels_html(const Figure& figure,
                        const std::string& id,
                        const std::vector<const Series*>& legend,
                        Palette& palette) {
  std::string out, empty;
  bool any = false;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const Panel& panel = figure.panels[i];
    if (figure.moment == 0 && !has_points(panel)) {
      empty += (empty.empty() ? "" : ", ") + html(panel.title);
      continue;
    }
    any = true;
    out += panel_html(
        panel, figure, fmt::format("{}-panel{}", id, i), legend, palette);
  }
  if (!any) return "<p class=\"nil\">not run</p>\n";
  out = fmt::format(
      "<div class=\"panels c{}\"{}>\n{}</div>\n",
      std::clamp(figure.columns,
                 1,
                 std::clamp(static_cast<int>(figure.panels.size()), 1, 4)),
      figure.moment > 0 ? fmt::format(" data-moment=\"{}\"", figure.moment)
                        : "",
      out);
  return empty.empty() ? out
                       : out + "<p class=\"nil\">not run: " + empty + "</p>\n";
}

}  // namespace

std::string figure_html(const Figure& figure,
                        const std::string& id,
                        const Palette& report) {
  Palette palette = palette_of(figure, report);
  const auto legend = legend_of(figure);
  const bool any =
      std::any_of(figure.panels.begin(), figure.panels.end(), has_points);
  std::string out =
      fmt::format("<figure id=\"{}\">\n<figcaption>{}</figcaption>\n{}{}",
                  id,
                  caption_html(id, figure.source, figure.title),
                  any ? legend_html(legend, palette) : "",
                  panels_html(figure, id, legend, palette));
  if (!figure.note.empty()) {
    out += fmt::format("<p class=\"remark\">{}</p>\n", html(figure.note));
  }
  return out + "</figure>\n";
}

}  // namespace physinv
