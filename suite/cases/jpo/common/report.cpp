#include "suite/cases/jpo/common/report.h"

#include <algorithm>

#include "suite/evidence/guests.h"
#include "suite/evidence/method_titles.h"
#include "suite/harness/registry.h"

namespace physinv {

std::string JpoReport::title() const {
  return registry().find(evidence_.experiment)->title;
}

std::vector<std::string> JpoReport::with_bfgs() const {
  std::vector<std::string> out{"bfgs"};
  out.insert(out.end(), options_.methods.begin(), options_.methods.end());
  return out;
}

std::vector<std::string> JpoReport::drawn() const {
  std::vector<std::string> out = with_bfgs();
  for (const auto& method : guests(evidence_)) out.push_back(method);
  return out;
}

Select JpoReport::ending(const std::string& method, bool refined) const {
  const auto added = guests(evidence_);
  return std::ranges::find(added, method) == added.end()
             ? jpo::ending(method, refined)
             : Select{method};
}

// With a network, if there is one: BFGS alone may have seen more problems.
Index JpoReport::largest_size() const {
  const auto all = sizes();
  Index largest = 0;
  for (const auto& method : options_.methods)
    for (const Run& run : find_runs(evidence_, jpo::plain(method)))
      largest = std::max(largest, run.n());
  return largest == 0 && !all.empty() ? all.back() : largest;
}

Figure JpoReport::picture() const {
  const Index n = largest_size();
  std::vector<PicturedMethod> methods;
  for (const auto& method : with_bfgs())
    methods.push_back(
        {method_title(method), jpo::at(jpo::ending(method, true), n)});
  const auto problem =
      registry().find(evidence_.experiment)->problem.make<double>();
  PictureOptions drawn = options_.picture;
  drawn.note += " BFGS refines what networks find.";
  return physinv::picture(
      drawn, pictured(evidence_, methods, problem->start(), drawn.worth));
}

Figure curves_with_descent(JpoReportOptions options,
                           FigureRef figure,
                           const Evidence& e) {
  const auto sizes = e.results.sizes(e.experiment);
  options.methods.insert(options.methods.begin(), "gd");
  options.curves = std::move(figure);
  if (!sizes.empty()) options.curve_sizes = {sizes.back()};
  Figure curves = JpoReport(options, e).curves();
  curves.columns = 1;
  return curves;
}

Section jpo_section(const JpoReportOptions& options, const Evidence& e) {
  const JpoReport report(options, e);
  Section section{.tables = {report.seconds(),
                             report.fit_share(),
                             report.better_equal(false),
                             report.better_equal(true),
                             report.results_table()},
                  .figures = {report.fraction(),
                              report.improvement(),
                              report.curves(),
                              report.trajectories(),
                              report.weight_change()},
                  .claims = {}};
  if (options.picture.draw)
    section.figures.insert(section.figures.begin(), report.picture());
  return section;
}

}  // namespace physinv
