#include "suite/cases/jpo_report.h"

namespace physinv {

std::string method_title(const std::string& method) {
  if (method == "bfgs") return "BFGS";
  if (method == "gd") return "Gradient descent";
  if (method == "jpo") return "JPO";
  if (method == "supervised") return "Supervised";
  if (method == "na") return "Neural adjoint";
  return method;
}

std::vector<std::string> JpoReport::with_bfgs() const {
  std::vector<std::string> out{"bfgs"};
  out.insert(out.end(), options_.methods.begin(), options_.methods.end());
  return out;
}

Section jpo_section(const JpoReportOptions& options,
                    const Results& results,
                    const Published& published) {
  const JpoReport report(options, results, published);
  return {.experiment = options.experiment,
          .title = options.title,
          .paper = options.paper,
          .tables = {report.seconds(),
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
}

}  // namespace physinv
