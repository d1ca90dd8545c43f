// With which batches the sentences of App. C come out.
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "suite/cases/hig/oscillators/ablation.h"
#include "suite/cases/hig/oscillators/quantities.h"
#include "suite/cases/hig/oscillators/study.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/claim.h"
#include "suite/evidence/of_experiment.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"

namespace physinv::hig::ablation_batch {
namespace {

using oscillators::Ids;
using oscillators::runs_of;

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
    return of_experiment(name_of(batch), q);
  };
  const auto between =
      oscillators::exponents([](double kappa) { return std::abs(kappa) < 1; });
  return {
      below(label("highest over lowest beta; of kappa from -3/4 to 1/2"),
            here(oscillators::spread_of(oscillators::kBetas, last_loss())),
            here(oscillators::spread_of(between, last_loss()))),
      at_most(label("kappa = -1/2 over the lowest other (lowest)"),
              here(ratio(median_at_end({"kappa-m05"}),
                         lowest_of(oscillators::kOtherExponents))),
              1.2),
      at_most(label("highest kappa from -3/4 to -1/4 over lowest above 0 "
                    "(orders of magnitude)"),
              here(ratio(highest_of({"kappa-m075", "kappa-m05", "kappa-m025"}),
                         lowest_of(oscillators::kPositive))),
              0.01),
      below(label("HIG's highest end of any tau over GN's lowest"),
            here(ratio(highest_of(oscillators::kHigCuts),
                       lowest_of(oscillators::kGnCuts))),
            1)};
}

Claim claim() {
  std::vector<Condition> all;
  for (const Index batch : kBatches)
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
  for (const Index batch : kBatches)
    table.columns.push_back(fmt::format("b = {}", batch));
  for (const auto& p : oscillators::ablation_points()) {
    TableRow shown{.label = p.id};
    for (const Index batch : kBatches)
      shown.cells.push_back(
          written(of_experiment(name_of(batch), median_at_end({p.id}))(e)));
    table.rows.push_back(std::move(shown));
  }
  return table;
}

std::vector<MethodLine> lines_of(const Ids& ids) {
  std::vector<MethodLine> lines;
  for (const auto& id : ids) lines.push_back({id, id});
  return lines;
}

Section report(Index batch,
               const Results& results,
               const Published& published) {
  const std::string name = name_of(batch);
  Section section{.experiment = name};
  if (batch == kBatches[0])
    section.tables.push_back(ends({results, published, name}));
  LearningCurves curves(results, section);
  curves.losses(lines_of(oscillators::kBetas),
                "fig12a",
                "Exponent beta of the prefactor",
                "Fig. 12a");
  curves.losses(lines_of(oscillators::exponents([](double) { return true; })),
                "fig12b",
                "Exponent kappa",
                "Fig. 12b");
  curves.losses(lines_of(oscillators::kHigCuts),
                "fig13a",
                "HIG: truncation tau",
                "Fig. 13");
  curves.losses(lines_of(oscillators::kGnCuts),
                "fig13b",
                "Gauss-Newton: truncation tau",
                "Fig. 13");
  return section;
}

}  // namespace

void add_claims(Registry& r) {
  r.add_claims(name_of(kBatches[0]), {claim()});
  for (const Index batch : kBatches)
    r.add_report(name_of(batch),
                 [batch](const Results& results, const Published& published) {
                   return report(batch, results, published);
                 });
}

}  // namespace physinv::hig::ablation_batch
