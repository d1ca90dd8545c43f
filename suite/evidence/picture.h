/// Pictures of what a problem is about: the truth, the first guess and what
/// each method found of one problem side by side, drawn from the stored
/// unknowns by the problem's own forward pass.
///
///   const auto shown = pictured(e, {{"BFGS", {"bfgs"}}, {"JPO", {"jpo"}}},
///                               problem.start());
///   picture({.title = "The shot", .draw = shot_panel}, shown)
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "suite/core/batch.h"
#include "suite/evidence/runs.h"
#include "suite/results/report_model.h"

namespace physinv {

/// Unknowns, and the name of their source.
struct FoundBy {
  std::string who;  ///< "truth", "start", "JPO"
  Vector<double> x;
};

/// One problem of a run.
struct Pictured {
  Index example = 0, examples = 0;  ///< its number, of how many
  std::uint64_t seed = 0;
  Index alike = 0;  ///< for how many of them `WorthShowing` holds
  Vector<double> given, y;
  std::vector<FoundBy> found;  ///< truth if it is known, start, methods
};

/// A method as a picture calls it, and its runs.
struct PicturedMethod {
  std::string who;
  Select runs;
};

/// Which problem is shown: the first one for which `holds`, or the first one.
struct WorthShowing {
  std::function<bool(const Vector<double>& given, const Vector<double>& y)>
      holds = {};
  std::string says = {};  ///< "whose first guess misses the other ball"
};

/// Of the first run of the first method that has one, the first problem that is
/// worth showing, or its first; methods that have the same problem (same data)
/// and finite unknowns for it. `start` is left out if it has no entries.
/// Nothing if no method was run, or none has stored unknowns.
std::optional<Pictured> pictured(const Evidence& e,
                                 const std::vector<PicturedMethod>& methods,
                                 const Vector<double>& start = {},
                                 const WorthShowing& worth = {});

struct PictureOptions {
  std::string title, note;
  WorthShowing worth = {};
  std::function<Panel(const FoundBy&, const Pictured&)> draw;
};

/// A panel for each, fields with one scale. The note says which problem it is.
/// Without a problem it has no panel, and its note says that unknowns are not
/// stored.
Figure picture(const PictureOptions& options,
               const std::optional<Pictured>& shown);

/// To four digits after the point, so that files of pictures stay small.
double few_digits(double value);

/// A circle as a line around it.
Series circle(std::string label,
              std::string method,
              double x,
              double y,
              double radius,
              PlotStyle style);

}  // namespace physinv
