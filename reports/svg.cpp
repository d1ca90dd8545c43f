#include "reports/svg.h"

#include <fmt/format.h>

#include <cmath>

namespace physinv {

std::string svg_number(double value) {
  if (!std::isfinite(value)) value = 0;
  std::string text = fmt::format("{:.2f}", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string svg_escape(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20) out += c;
    }
  }
  return out;
}

Svg::Svg(double width,
         double height,
         std::string_view title,
         std::string_view description,
         std::string_view style) {
  const std::string w = svg_number(width), h = svg_number(height);
  open("svg",
       {{"xmlns", "http://www.w3.org/2000/svg"},
        {"viewBox", fmt::format("0 0 {} {}", w, h)},
        {"width", w},
        {"height", h},
        {"role", "img"}});
  out_ += fmt::format("<title>{}</title>\n<desc>{}</desc>\n",
                      svg_escape(title),
                      svg_escape(description));
  out_ += fmt::format("<style>{}</style>\n", style);
}

Svg Svg::inlined(double width,
                 double height,
                 std::string_view title,
                 std::string_view description) {
  Svg svg;
  svg.open("svg",
           {{"viewBox",
             fmt::format("0 0 {} {}", svg_number(width), svg_number(height))},
            {"role", "img"}});
  svg.out_ += fmt::format("<title>{}</title>\n<desc>{}</desc>\n",
                          svg_escape(title),
                          svg_escape(description));
  return svg;
}

Svg Svg::ornament(double width, double height) {
  const std::string w = svg_number(width), h = svg_number(height);
  Svg svg;
  svg.open("svg",
           {{"viewBox", fmt::format("0 0 {} {}", w, h)},
            {"width", w},
            {"height", h},
            {"aria-hidden", "true"}});
  return svg;
}

void Svg::begin(std::string_view name, Attributes attributes) {
  out_ += fmt::format("<{}", name);
  for (const auto& [key, value] : attributes) {
    if (!value.empty()) {
      out_ += fmt::format(" {}=\"{}\"", key, svg_escape(value));
    }
  }
}

void Svg::open(std::string_view name, Attributes attributes) {
  begin(name, attributes);
  out_ += ">\n";
  open_.emplace_back(name);
}

void Svg::close() {
  out_ += fmt::format("</{}>\n", open_.back());
  open_.pop_back();
}

void Svg::leaf(std::string_view name, Attributes attributes) {
  begin(name, attributes);
  out_ += "/>\n";
}

void Svg::line(
    std::string_view css, double x1, double y1, double x2, double y2) {
  leaf("line",
       {{"class", std::string(css)},
        {"x1", svg_number(x1)},
        {"y1", svg_number(y1)},
        {"x2", svg_number(x2)},
        {"y2", svg_number(y2)}});
}

void Svg::rect(std::string_view css, double x, double y, double w, double h) {
  leaf("rect",
       {{"class", std::string(css)},
        {"x", svg_number(x)},
        {"y", svg_number(y)},
        {"width", svg_number(w)},
        {"height", svg_number(h)}});
}

void Svg::path(std::string_view css, std::string d) {
  if (!d.empty()) leaf("path", {{"class", std::string(css)}, {"d", d}});
}

void Svg::text(std::string_view css,
               double x,
               double y,
               std::string_view words,
               std::string_view anchor,
               bool turned) {
  const std::string px = svg_number(x), py = svg_number(y);
  begin(
      "text",
      {{"class", std::string(css)},
       {"x", px},
       {"y", py},
       {"text-anchor", anchor == "start" ? "" : std::string(anchor)},
       {"transform", turned ? fmt::format("rotate(-90 {} {})", px, py) : ""}});
  out_ += fmt::format(">{}</text>\n", svg_escape(words));
}

std::string Svg::str() && {
  while (!open_.empty()) close();
  return std::move(out_);
}

}  // namespace physinv
