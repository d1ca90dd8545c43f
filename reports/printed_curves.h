/// What papers print of their curves: levels, points and spans, drawn next to
/// ours. From "curves" of reports/published/<paper>.json:
///   experiment, figure  whose figure it is
///   panels              titles, or labels of x where there are none; absent:
///   all method              in whose colour; it is drawn where the method is
///   label, where        for the legend, and the place in the paper
/// and one of
///   level   [lowest, y, highest], and "between": [x, x] unless everywhere
///   points  [[x, lowest, y, highest], ...]
///   span    [x, x]
/// Lowest and highest are the error of reading: of a number its rounding.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

struct PrintedPoint {
  double x = 0, lowest = 0, y = 0, highest = 0;
};

struct PrintedCurve {
  std::string experiment, figure, method, label, where;
  std::vector<std::string> panels = {};
  std::vector<PrintedPoint> points = {};
  std::optional<PrintedPoint> level = {};  ///< at any x
  /// Of a level: where it holds; alone: a span.
  std::optional<std::array<double, 2>> between = {};
};

/// Those of the papers' files; StoreError with file and reason if one is
/// malformed. Papers without a file have none.
std::vector<PrintedCurve> printed_curves(
    const std::filesystem::path& directory,
    const std::vector<std::string>& papers);
/// Those in the bytes of a file; `path` is for messages.
std::vector<PrintedCurve> printed_curves(std::string_view bytes,
                                         const std::filesystem::path& path);

/// Adds to the section's figures what the paper prints of them, dashed, with
/// the places in their notes.
void draw_printed(const std::vector<PrintedCurve>& curves, Section& section);

}  // namespace physinv
