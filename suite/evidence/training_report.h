/// What experiments that train one network report: test losses over updates,
/// over our time and over the paper's.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "suite/evidence/runs.h"
#include "suite/results/published.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv {

template <class T>
class Problem;

/// Finished chains of training stages at the experiment's only n, one for each
/// seed that has one, and their last stages.
std::vector<const CaseRecord*> trained_chains(const Evidence& e,
                                              std::string_view method);
std::vector<const StageRecord*> trained_stages(const Evidence& e,
                                               std::string_view method);

/// An example of the first seed: what was asked and what a method's network
/// answers. Empty if it was not run to its end, or on fewer examples.
struct Answered {
  Vector<double> given, wanted, truth;  ///< truth: no entries if not known
  Vector<double> x;
};
std::optional<Answered> answer_of(const Evidence& e,
                                  std::string_view method,
                                  Index example = 0);

/// A method as a figure shows it.
struct MethodLine {
  std::string method, label;
  std::optional<Hue> hue = {};              ///< empty: the next free one
  std::optional<double> paper_update = {};  ///< seconds by the paper
  std::string key = {};  ///< lines of one look alike; empty: the method
};

/// a, then the lines of b whose methods a lacks.
std::vector<MethodLine> joined(std::vector<MethodLine> a,
                               const std::vector<MethodLine>& b);

/// What an experiment's tables and figures call its methods.
std::map<std::string, std::string> titles_of(
    const std::vector<MethodLine>& lines);

/// What a problem makes of an answer.
Vector<double> observed(const Problem<double>& problem, const Answered& answer);

/// How fields of examples are drawn.
struct AnsweredFields {
  std::string where;
  Index examples = 1;  ///< the first ones
  std::function<Panel(std::string, const Vector<double>&)> picture;
  /// What is observed of an answer.
  std::function<Vector<double>(const Answered&)> observe;
};

/// The first line that answers of those whose labels are the same up to a comma
/// ("SIP", "SIP, batch 8").
std::vector<MethodLine> one_of_each(const Evidence& e,
                                    const std::vector<MethodLine>& lines);

/// A picture of the first seed, in pairs for each example: what is observed and
/// the truth; then for `one_of_each` what would be observed of its answer, and
/// the answer. All answers have a scale that reaches at least as far as the
/// truth's, all observations one that reaches as far as the first.
Figure answered_fields(const Evidence& e,
                       const std::vector<MethodLine>& lines,
                       const AnsweredFields& drawn);

/// Seconds of an update by a row of the paper's tables ("table3/hig/b=128").
std::optional<double> paper_update(const Evidence& e, std::string_view row);

/// Of a series that shows this line; markers go with the hues.
inline std::optional<PlotStyle> style_of(const MethodLine& line) {
  if (!line.hue) return {};
  return PlotStyle{*line.hue, static_cast<Marker>(*line.hue)};
}

/// A series of its looks and its name, without a point.
inline Series series_of(const MethodLine& line) {
  return {.label = line.label,
          .method = line.key.empty() ? line.method : line.key,
          .style = style_of(line)};
}

/// Draws learning curves into an experiment's section: medians over seeds, with
/// 10 % and 90 % quantiles as a band. What shows nothing is left out, lines and
/// figures.
class LearningCurves {
 public:
  LearningCurves(const Evidence& evidence, Section& section)
      : evidence_(evidence), section_(section) {}

  /// Test loss over updates, over solving time and, for lines that know it,
  /// over the paper's time; of the last stage.
  void losses(const std::vector<MethodLine>& lines,
              std::string id,
              std::string title,
              std::string where);

  /// The same over all stages of each method's chain, joined.
  void chains(const std::vector<MethodLine>& lines,
              std::string id,
              std::string title,
              std::string where);

  /// Row `row` of the array `metrics` over updates.
  void metric(const std::vector<MethodLine>& lines,
              Index row,
              std::string y_label,
              std::string id,
              std::string title,
              std::string where);

  /// Panels for figures of another form: the test loss, a row of `metrics`.
  Panel panel(const std::vector<MethodLine>& lines) const;
  Panel metric_panel(const std::vector<MethodLine>& lines,
                     Index row,
                     std::string y_label) const;

  void add(Figure figure);

 private:
  /// With those in Python, in the section's first figure of losses.
  std::vector<MethodLine> with_guests(std::vector<MethodLine> lines);

  const Evidence& evidence_;
  Section& section_;
  bool guests_drawn_ = false;
};

/// Those in Python that no line names, which answer each example on its own.
std::vector<MethodLine> guest_lines(const Evidence& e,
                                    const std::vector<MethodLine>& lines);

/// Per method with results, those in Python too: test loss at the end, seconds
/// and bytes per update.
Table loss_table(const Evidence& e, const std::vector<MethodLine>& lines);

/// CPU time of an update over the size of its batch: a curve for the lines
/// whose labels are the same up to a comma ("SIP", "SIP, batch 8").
Figure update_times(const Evidence& e,
                    const std::vector<MethodLine>& lines,
                    std::string where);

/// A method next to a row of the paper's tables of memory and durations.
struct CostLine {
  std::string method, label;
  std::string published;  ///< "table3/hig/b=128"
  Select jacobian = {};   ///< what takes its Jacobian alone
};

/// Memory and duration of an update and, where that was timed, of its Jacobian,
/// ours and the paper's.
Table cost_table(const Evidence& e,
                 const std::vector<CostLine>& lines,
                 std::string where);

}  // namespace physinv
