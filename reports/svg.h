/// Writes SVG text whose bytes depend on nothing but the calls made.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace physinv {

/// At most two digits after the point, no trailing zeros, never "-0".
/// Values that are not finite read 0; callers leave such points out.
std::string svg_number(double value);

/// Text for XML: markup characters escaped, control characters dropped.
std::string svg_escape(std::string_view text);

class Svg {
 public:
  using Attribute = std::pair<std::string_view, std::string>;
  using Attributes = std::initializer_list<Attribute>;

  /// `style` is CSS; title and description are for screen readers.
  Svg(double width,
      double height,
      std::string_view title,
      std::string_view description,
      std::string_view style);

  /// One that is part of an HTML page, as wide as its place, and takes its
  /// style from there.
  static Svg inlined(double width,
                     double height,
                     std::string_view title,
                     std::string_view description);
  /// An ornament of such a page, in its own size; screen readers pass by.
  static Svg ornament(double width, double height);

  void open(std::string_view name, Attributes attributes = {});
  void close();
  void leaf(std::string_view name, Attributes attributes);
  void line(std::string_view css, double x1, double y1, double x2, double y2);
  void rect(std::string_view css, double x, double y, double w, double h);
  void path(std::string_view css, std::string d);
  /// `anchor` is start, middle or end; `turned` reads upwards.
  void text(std::string_view css,
            double x,
            double y,
            std::string_view words,
            std::string_view anchor = "start",
            bool turned = false);

  /// The finished document; everything open is closed.
  std::string str() &&;

 private:
  Svg() = default;
  void begin(std::string_view name, Attributes attributes);
  std::string out_;
  std::vector<std::string> open_;
};

}  // namespace physinv
