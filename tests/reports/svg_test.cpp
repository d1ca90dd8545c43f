#include "reports/svg.h"

#include <gtest/gtest.h>

#include <clocale>
#include <limits>

#include "tests/reports/xml_check.h"

namespace physinv {
namespace {

TEST(SvgNumber, ShortAndFixed) {
  EXPECT_EQ(svg_number(1.5), "1.5");
  EXPECT_EQ(svg_number(100), "100");
  EXPECT_EQ(svg_number(-0.001), "0");
  EXPECT_EQ(svg_number(2.0 / 3), "0.67");
  EXPECT_EQ(svg_number(std::numeric_limits<double>::quiet_NaN()), "0");
}

TEST(SvgNumber, IgnoresTheLocale) {
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  EXPECT_EQ(svg_number(1234567.25), "1234567.25");
  std::setlocale(LC_ALL, "C");
}

TEST(Svg, GoldenBytes) {
  Svg svg(20, 10, "a < b", "\x01 & more", ".l{fill:none}");
  svg.open("g", {{"clip-path", "url(#c)"}});
  svg.line("l", 0, 0.126, 5, 1e-9);
  svg.close();
  svg.path("l", "");
  svg.text("t", 1, 2, "x \"y\"", "middle", true);
  EXPECT_EQ(std::move(svg).str(),
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 20 10\" "
            "width=\"20\" height=\"10\" role=\"img\">\n"
            "<title>a &lt; b</title>\n<desc> &amp; more</desc>\n"
            "<style>.l{fill:none}</style>\n"
            "<g clip-path=\"url(#c)\">\n"
            "<line class=\"l\" x1=\"0\" y1=\"0.13\" x2=\"5\" y2=\"0\"/>\n"
            "</g>\n"
            "<text class=\"t\" x=\"1\" y=\"2\" text-anchor=\"middle\" "
            "transform=\"rotate(-90 1 2)\">x &quot;y&quot;</text>\n"
            "</svg>\n");
}

TEST(Svg, ClosesWhatIsOpen) {
  Svg svg(1, 1, "", "", "");
  svg.open("g");
  EXPECT_EQ(xml_error(std::move(svg).str()), "");
}

TEST(XmlCheck, SeesMistakes) {
  EXPECT_NE(xml_error("<a><b></a></b>"), "");
  EXPECT_NE(xml_error("<a x=\"1\" x=\"2\"/>"), "");
  EXPECT_NE(xml_error("<a>&</a>"), "");
  EXPECT_NE(xml_error("<a/><b/>"), "");
}

}  // namespace
}  // namespace physinv
