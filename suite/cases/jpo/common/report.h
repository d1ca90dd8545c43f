/// Tables and figures that every experiment of the JPO paper shares.
/// Absent stages read "not run"; claims are added by the experiment itself.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "suite/cases/jpo/common/values.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/picture.h"
#include "suite/results/published.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv {

/// Where the paper shows a figure: file name and printed number.
struct FigureRef {
  std::string id, where;
};

/// The paper's numbers are looked up under these names (of the experiment):
/// table2/bfgs, table2/<method>/<stage>, table3/n=<n>, table4/<method>/better
/// and /equal, table5 likewise.
struct JpoReportOptions {
  std::vector<std::string> methods = {"jpo", "supervised", "na"};
  Solved solved = 1e-6;            ///< when a problem counts as solved
  std::vector<Index> curve_sizes;  ///< of fig. 12; default: four present
  Index trajectory_size = 0;       ///< of fig. 13; default: the largest
  std::vector<Index> table3_sizes = {4, 8, 32, 128};
  bool from_prior = false;            ///< Table 3, see decrease_before
  std::vector<std::string> unknowns;  ///< names of the unknowns, for axes
  /// What trajectories should reach, unknowns x examples; data.x if empty.
  std::function<Batch<double>(const CaseRecord&)> solution;
  FigureRef fraction{"fig4b", "Fig. 4b"};
  FigureRef improvement{"fig11", "Fig. 11"};
  FigureRef curves{"fig12", "Fig. 12"};
  FigureRef trajectories{"fig13", "Fig. 13"};
  FigureRef weight_change{"fig14", "Fig. 14"};
  PictureOptions picture = {};  ///< how x is drawn; none without `draw`
};

/// The paper's colours.
inline const PlotStyles kJpoStyles = {
    {"bfgs", {Hue::blue, Marker::circle}},
    {"jpo", {Hue::orange, Marker::square}},
    {"supervised", {Hue::green, Marker::triangle}},
    {"na", {Hue::red, Marker::diamond}},
    {"gd", {Hue::purple, Marker::down}},
    {"truth", {Hue::ink, Marker::cross}}};

class JpoReport {
 public:
  /// Of the experiment that asks; both have to outlive it.
  JpoReport(const JpoReportOptions& options, const Evidence& evidence)
      : options_(options), evidence_(evidence) {}

  Table seconds() const;                   ///< Table 2, at the largest n
  Table fit_share() const;                 ///< Table 3
  Table better_equal(bool refined) const;  ///< Table 4, refined Table 5
  Table results_table() const;             ///< per n and method

  /// A problem of the largest set: BFGS and what refines the networks' answers.
  Figure picture() const;
  Figure fraction() const;       ///< f_N over n of JPO and gradient descent
  Figure improvement() const;    ///< loss and f_N, before and after
  Figure curves() const;         ///< loss over iterations for four n
  Figure trajectories() const;   ///< estimates of examples 0..3, largest n
  Figure weight_change() const;  ///< by tensor over n

  Index largest_size() const;  ///< of problems, with a network if there is one

 private:
  /// What represents the seeds: quantiles on logarithmic axes.
  enum class Over { means, quantiles };
  std::vector<Index> sizes() const {
    return evidence_.results.sizes(evidence_.experiment);
  }
  std::string title() const;  ///< of the experiment
  /// A number for each seed.
  std::vector<double> values(const Select& runs,
                             Index n,
                             const RunValue& value) const;
  Series over_n(std::string label,
                std::string method,
                const Select& runs,
                const RunValue& value,
                Over over = Over::means) const;
  /// The end of the first seed's chain before its refinement, null without.
  const StageRecord* of_first_seed(const std::string& method, Index n) const;
  Series f_series(const std::string& method, bool refined) const;
  Series loss_series(const std::string& method, bool refined) const;
  Series reference_half() const;
  Series curve_series(const std::string& method, Index n) const;
  std::vector<Index> sizes_of_curves() const;
  Index size_of_trajectories() const;
  Panel plane(Index n, Index example) const;
  Panel over_iterations(Index n, Index example, Index unknown) const;
  Panel tensor_panel(const std::string& which,
                     const std::vector<std::string>& names,
                     const std::vector<Index>& tensors) const;
  std::string unknown_name(Index j) const;
  std::vector<std::string> with_bfgs() const;
  /// And those in Python.
  std::vector<std::string> drawn() const;
  /// Those in Python end with their last stage.
  Select ending(const std::string& method, bool refined) const;
  std::optional<double> solution_of(Index n, Index example, Index j) const;

  Cell over_seeds(const Select& runs, Index n, const RunValue& value) const;
  Cell over_runs(const Select& runs, const RunValue& share) const;
  Cell seconds_cell(const Select& runs, Index n, TimedStages& timed) const;
  TableRow results_row(const std::string& method,
                       Index n,
                       bool refined,
                       TimedStages& timed) const;
  Cell with_paper(Cell cell, const std::string& quantity) const;

  const JpoReportOptions& options_;
  const Evidence& evidence_;
};

/// All of the above in the order of the paper.
Section jpo_section(const JpoReportOptions& options, const Evidence& e);

/// The curves of the largest set alone, those of gradient descent among them.
Figure curves_with_descent(JpoReportOptions options,
                           FigureRef figure,
                           const Evidence& e);

}  // namespace physinv
