// With which batches the sentences of App. C come out.
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "suite/cases/hig/oscillators/ablation.h"
#include "suite/cases/hig/oscillators/quantities.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/claim.h"
#include "suite/evidence/study_table.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"

namespace physinv::oscillators::ablation_batch {
namespace {

Quantity lowest_of(const Ids& ids) {
  return least(medians(runs_of(ids), last_loss()));
}
Quantity highest_of(const Ids& ids) {
  return most(medians(runs_of(ids), last_loss()));
}

/// The sentences of App. C about Figs. 12a, 12b and 13.
std::vector<Condition> sentences(Index batch) {
  const auto label = [&](const char* what) {
    return fmt::format("b = {}: {}", batch, what);
  };
  const auto here = [&](const Quantity& q) {
    return of_experiment(study_of(batch), q);
  };
  const auto between =
      exponents([](double kappa) { return std::abs(kappa) < 1; });
  return {
      below(label("highest over lowest beta; of kappa from -3/4 to 1/2"),
            here(spread_of(kBetas, last_loss())),
            here(spread_of(between, last_loss()))),
      at_most(
          label("kappa = -1/2 over the lowest other (lowest)"),
          here(ratio(median_at_end({"kappa-m05"}), lowest_of(kOtherExponents))),
          1.2),
      at_most(label("highest kappa from -3/4 to -1/4 over lowest above 0 "
                    "(orders of magnitude)"),
              here(ratio(highest_of({"kappa-m075", "kappa-m05", "kappa-m025"}),
                         lowest_of(kPositive))),
              0.01),
      below(label("HIG's highest end of any tau over GN's lowest"),
            here(ratio(highest_of(kHigCuts), lowest_of(kGnCuts))),
            1)};
}

Claim claim() {
  std::vector<Condition> all;
  for (const Index batch : kAblationBatches)
    for (Condition& c : sentences(batch)) all.push_back(std::move(c));
  return {.id = "S1",
          .from = "study",
          .says =
              "beta has little influence, kappa = -1/2 ends lowest, kappa < "
              "0 orders of magnitude below kappa > 0, and HIG below GN for "
              "every tau, whatever the batch",
          .conditions = std::move(all),
          .note = "After 2000 updates, 290 s by the paper's clock.",
          .cause = depends("the batch of Figs. 12 and 13 is not printed; the "
                           "table has both")};
}

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

std::vector<MethodLine> lines_of(const Ids& ids) {
  std::vector<MethodLine> lines;
  for (const auto& id : ids) lines.push_back({id, id});
  return lines;
}

Section report(const Evidence& e) {
  Section section;
  if (e.experiment == study_of(kAblationBatches[0]))
    section.tables.push_back(ends(e));
  LearningCurves curves(e, section);
  curves.losses(
      lines_of(kBetas), "fig12a", "Exponent beta of the prefactor", "Fig. 12a");
  curves.losses(lines_of(exponents([](double) { return true; })),
                "fig12b",
                "Exponent kappa",
                "Fig. 12b");
  curves.losses(lines_of(kHigCuts), "fig13a", "HIG: truncation tau", "Fig. 13");
  curves.losses(
      lines_of(kGnCuts), "fig13b", "Gauss-Newton: truncation tau", "Fig. 13");
  return section;
}

}  // namespace

void add_claims(Registry& r) {
  r.add_claims(study_of(kAblationBatches[0]), {claim()});
  for (const Index batch : kAblationBatches)
    r.add_report(study_of(batch), report);
}

}  // namespace physinv::oscillators::ablation_batch
