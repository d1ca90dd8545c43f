// The figures of App. C by batch.
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "suite/cases/hig/oscillators/ablation.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/study_table.h"
#include "suite/evidence/training.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"

namespace physinv::oscillators::ablation_batch {
namespace {

Table ends(const Evidence& e) {
  Table table{.id = "ends",
              .title = "Test loss after 2000 updates by batch",
              .where = "App. C, Figs. 12, 13",
              .corner = "method",
              .note =
                  "Medians over seeds. kappa-m05 and kappa-m1 are HIG and "
                  "Gauss-Newton with tau = 1e-6."};
  StudyTable<AblationPoint> study{
      .settings = ablation_points(),
      .title = [](const AblationPoint& p) { return p.id; }};
  for (const Index batch : kAblationBatches)
    study.columns.push_back(
        {fmt::format("b = {}", batch), [=](const AblationPoint& p) {
           return of_experiment(study_of(batch), median_at_end({p.id}));
         }});
  return study.rows(
      std::move(table), e, [](const Measured& m) { return written(m); });
}

std::vector<MethodLine> lines_of(const std::vector<std::string>& ids) {
  return each(ids, [](const auto& id) { return MethodLine{id, id}; });
}

Section report(const Evidence& e) {
  Section section;
  if (e.experiment == study_of(kAblationBatches[0]))
    section.tables.push_back(ends(e));
  LearningCurves curves(e, section);
  curves.losses(
      lines_of(
          {"kappa-m05", "beta-m125", "beta-m250", "beta-m375", "beta-m500"}),
      "fig12a",
      "Exponent beta of the prefactor",
      "Fig. 12a");
  curves.losses(each(kExponents,
                     [](const Exponent& p) {
                       return MethodLine{p.id, p.id};
                     }),
                "fig12b",
                "Exponent kappa",
                "Fig. 12b");
  curves.losses(lines_of({"hig-tau5",
                          "kappa-m05",
                          "hig-tau7",
                          "hig-tau8",
                          "hig-tau9",
                          "hig-tau10"}),
                "fig13a",
                "HIG: truncation tau",
                "Fig. 13");
  curves.losses(
      lines_of(
          {"gn-tau5", "kappa-m1", "gn-tau7", "gn-tau8", "gn-tau9", "gn-tau10"}),
      "fig13b",
      "Gauss-Newton: truncation tau",
      "Fig. 13");
  return section;
}

}  // namespace

void add_reports(Registry& r) {
  for (const Index batch : kAblationBatches)
    r.add_report(study_of(batch), report);
}

}  // namespace physinv::oscillators::ablation_batch
