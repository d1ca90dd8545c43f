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
  PanelPlot plot(panel, id, palette);
  const double height = plot.height(size.w, size.h);
  Svg svg = Svg::inlined(
      size.w,
      height,
      name,
      panel.space || panel.y_label.empty()
          ? figure.title
          : fmt::format("{} over {}", panel.y_label, panel.x_label));
  std::vector<int> keys;
  for (const Series& s : panel.series) keys.push_back(legend_index(legend, s));
  plot.set_keys(std::move(keys));
  plot.draw(svg, {0, 0, size.w, height});
  return std::move(svg).str();
}

void list(std::string& words, const std::string& more, const char* between) {
  words += (words.empty() || more.empty() ? "" : between) + more;
}

/// Panels below their legend. Those without a point and those that show one
/// number are words: which they are, or that none was run. The moments of a
/// film stay together.
std::string panels_html(const Figure& figure,
                        const std::string& id,
                        const std::vector<const Series*>& legend,
                        Palette& palette) {
  if (figure.picture && figure.panels.empty()) return "";  // its note says why
  std::string out, empty, constant;
  int drawn = 0;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const Panel& panel = figure.panels[i];
    if (figure.moment == 0 && !has_points(panel)) {
      list(empty, panel.title.empty() ? panel.x_label : panel.title, ", ");
      continue;
    }
    if (const auto value = constant_of(panel); value && figure.moment == 0) {
      list(constant,
           fmt::format("{}{}{} is {:.4g} throughout",
                       panel.title,
                       panel.title.empty() ? "" : ": ",
                       panel.y_label.empty() ? "it" : panel.y_label,
                       *value),
           "; ");
      continue;
    }
    ++drawn;
    out += panel_html(
        panel, figure, fmt::format("{}-panel{}", id, i), legend, palette);
  }
  if (drawn == 0 && constant.empty()) return nil_html("not run");
  if (!empty.empty()) empty = "not run: " + empty;
  list(empty, undrawn_text(figure), "; ");
  const std::string words = nil_html(constant) + nil_html(empty);
  if (drawn == 0) return words;
  return legend_html(legend, palette) +
         fmt::format("<div class=\"panels c{}\"{}>\n{}</div>\n",
                     std::clamp(figure.columns, 1, std::min(drawn, 4)),
                     figure.moment > 0
                         ? fmt::format(" data-moment=\"{}\"", figure.moment)
                         : "",
                     out) +
         words;
}

}  // namespace

std::string figure_html(const Figure& figure,
                        const std::string& id,
                        const Palette& report) {
  Palette palette = palette_of(figure, report);
  const auto legend = legend_of(figure);
  std::string out =
      fmt::format("<figure id=\"{}\"{}>\n<figcaption>{}</figcaption>\n{}",
                  id,
                  figure.picture ? " class=\"picture\"" : "",
                  caption_html(id, figure.where, figure.title),
                  panels_html(figure, id, legend, palette));
  if (!figure.note.empty()) {
    out += fmt::format("<p class=\"remark\">{}</p>\n", html(figure.note));
  }
  return out + "</figure>\n";
}

}  // namespace physinv
