/// What an experiment reports, free of any file format: tables, figures and
/// judged claims. Case files fill it from `Results`; reports render it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "suite/core/counts.h"

namespace physinv {

/// A measured number next to a published one. Absent values are absent, never
/// 0.
struct Cell {
  std::optional<double> ours, spread;  ///< mean, std over seeds
  std::optional<double> paper, paper_spread;
  std::string text;     ///< shown instead of numbers if not empty ("not run")
  std::string of = {};  ///< what the number is of, next to it in tidy files
};

struct TableRow {
  std::string label;
  std::vector<Cell> cells;
  std::vector<std::string> keys = {};  ///< values of Table::keys
};

/// Columns that are values of a key: the quantities of the first value, those
/// of the next.
struct Across {
  std::string key;                           ///< "method"
  std::vector<std::string> values = {};      ///< empty: as the columns
  std::vector<std::string> quantities = {};  ///< empty: one, "value"
};

struct Table {
  std::string id;      ///< file name: table4
  std::string title;   ///< one line
  std::string where;   ///< "Table 4"
  std::string unit;    ///< "%", "s", "" - for all cells
  int digits = 1;      ///< after the point
  std::string corner;  ///< head of the label column
  std::vector<std::string> columns;
  std::vector<TableRow> rows;
  std::string note;
  /// For tidy files: parts of a row's label ("n", "method"); empty: the corner.
  std::vector<std::string> keys = {};
  std::optional<Across> across = {};
};

/// Colours that differ for everybody, on light and on dark pages.
enum class Hue {
  blue,
  orange,
  green,
  red,
  purple,
  ink,
  brown,
  teal,
  pink,
  grey,
  olive,
  indigo
};
enum class Marker { circle, square, triangle, diamond, down, cross };

/// How a method is drawn everywhere in an experiment's report.
struct PlotStyle {
  Hue hue = Hue::blue;
  Marker marker = Marker::circle;
};

struct Series {
  std::string label;
  std::string method;  ///< what is drawn: series of one method look alike
  std::vector<double> x, y;
  std::vector<double> lo, hi;  ///< band or error bar, empty for none
  bool line = true;            ///< joined points
  bool markers = false;        ///< a mark at each point
  bool dashed = false;
  std::optional<PlotStyle> style = {};  ///< empty: the next free colour
};

/// A grid of values over two axes, drawn as a heat map: value(i, j) =
/// values[j * x.size() + i].
struct Field2D {
  std::vector<double> x, y, values;
  /// Labels of the axes instead of numbers, if not empty.
  std::vector<std::string> x_names = {}, y_names = {};
  bool log_scale = false;
  std::string label;
  /// Colours reach at least so far: fields that are compared share a scale.
  std::optional<double> min = {}, max = {};
};

/// Vectors (u, v) at points (x, y), drawn over a field; the longest has that
/// length in units of x.
struct Arrows {
  std::vector<double> x, y, u, v;
  double length = 1;
};

struct Panel {
  std::string title, x_label, y_label;
  bool x_log = false, y_log = false;
  std::vector<Series> series;
  std::optional<Field2D> field;  ///< drawn below the series
  std::optional<Arrows> arrows = {};
  std::optional<double> y_min, y_max;
  std::optional<double> x_min = {}, x_max = {};
  /// Shows a place without ticks: one unit is as long along x as along y. Has a
  /// field, whose cells are squares, or all four limits.
  bool space = false;
};

struct Figure {
  std::string id;     ///< file name: fig11
  std::string title;  ///< one line
  std::string where;  ///< "Fig. 11"
  std::vector<Panel> panels;
  int columns = 2;  ///< panels per row
  std::string note;
  /// So many panels after each other are one moment of a film; 0: no film.
  int moment = 0;
  /// Shows what the problem is about; is shown before the paper's figures. One
  /// without panels says in its note why there is nothing to draw.
  bool picture = false;
};

/// Whose claim it is: a sentence, number or figure of the paper, or a range
/// that earlier runs of this suite or of independent programs showed.
enum class Origin { paper, suite };

/// The outcome of a claim. Where a condition fails, the claim's cause may tell
/// more than that: `differs`, `depends` and `contradiction` are explained.
enum class Verdict {
  reproduced,
  stronger,       ///< than printed, in the same direction
  weaker,         ///< than printed, in the same direction
  differs,        ///< one of the two; older files do not say which
  depends,        ///< on a choice that the paper does not print
  contradiction,  ///< tables, formulas or sentences of the paper disagree
  not_reproduced,
  partly_judged,  ///< what was run holds; some is missing or too short
  not_judged,     ///< runs are missing or too short
  reported        ///< numbers that no condition decides
};
inline constexpr int kVerdictCount = 10;

/// One condition of a claim and what was measured for it.
struct ConditionResult {
  std::string label;   ///< "Adam / HIG", by which its number is kept
  std::string bounds;  ///< "> 2"; empty: a number alone
  std::optional<double> value, spread;  ///< std over seeds
  std::int64_t runs = 0;                ///< behind the value
  std::optional<bool> holds;            ///< empty: not decided
  std::string missing;                  ///< what is not there
  std::string shown = {};               ///< instead of the label, if any

  const std::string& text() const { return shown.empty() ? label : shown; }
};

struct ClaimResult {
  std::string id;    ///< R3
  std::string says;  ///< the claim in one sentence
  std::string from;  ///< lowest profile that can judge it
  bool gates = false;
  Verdict verdict = Verdict::not_judged;
  std::string evidence;  ///< the numbers behind it, one line
  Origin origin = Origin::suite;
  std::string where = {};  ///< place in the paper
  std::string note = {};
  std::vector<ConditionResult> conditions = {};
  /// Why it is not reproduced, one line; of a claim that is, stale.
  std::string cause = {};
  std::vector<ConditionResult> shown_by = {};  ///< of the cause
};

/// One experiment's part of a report.
struct Section {
  std::string experiment, title, paper;
  std::vector<Table> tables;
  std::vector<Figure> figures;
  std::vector<ClaimResult> claims;
  std::map<std::string, std::string> method_titles;  ///< jpo -> JPO
  std::string standing = {};        ///< how its methods compare, a sentence
  std::optional<Counts> work = {};  ///< of all its stages
};

/// By what is drawn (`Series::method`).
using PlotStyles = std::map<std::string, PlotStyle>;
/// Series whose method has a style get it.
void apply(const PlotStyles& styles, std::vector<Figure>& figures);

}  // namespace physinv
