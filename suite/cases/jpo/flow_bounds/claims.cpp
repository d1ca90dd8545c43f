// What claims.md asks for: a number of each setting, which a table shows, too.
#include "suite/cases/common/claims.h"

#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "suite/cases/jpo/common/values.h"
#include "suite/cases/jpo/flow_bounds/settings.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/study_table.h"

namespace physinv::flow_bounds {
namespace {

constexpr Index kSeeds = 4;  ///< the paper's
const Select kBfgsRuns{"bfgs"};

// ---- numbers of a setting ---------------------------------------------------

/// Of BFGS on the largest set of each seed.
Quantity within_ten() {
  return percent(share_of_examples(kBfgsRuns,
                                   jpo::largest_sets(iterations()),
                                   [](double k) { return k <= 10; }));
}
Quantity most_iterations() {
  return highest(kBfgsRuns, of_row(iterations(), most_of));
}
/// How large outliers are.
Quantity mean_over_median() {
  return median(kBfgsRuns, jpo::largest_sets(RunValue([](const Run& run) {
                  std::vector<double> all = losses()(run);
                  const double mean = mean_of(all);
                  return std::optional(mean / physinv::median(std::move(all)));
                })));
}
Quantity jpo_over_bfgs() {
  return depends_on(
      jpo::lowest_mean(jpo::kJpo, jpo::over_bfgs(jpo::mean_loss())),
      {kBfgsRuns});
}
template <bool kIsRefined>
Quantity better() {
  return percent(
      depends_on(mean(kIsRefined ? jpo::kRefined : jpo::kJpo, jpo::better()),
                 {kBfgsRuns}));
}

// ---- columns ----------------------------------------------------------------

template <Quantity (*kOf)()>
Quantity of(const Choice&) {
  return kOf();
}

const StudyTable<Choice> kStudy{
    .settings = {std::begin(kChoices), std::end(kChoices)},
    .columns = {{"BFGS within 10 iterations, % (usually)",
                 of<within_ten>,
                 asks_above(50)},
                {"most iterations (40)", of<most_iterations>, asks_at_most(40)},
                {"mean loss of BFGS over its median", of<mean_over_median>},
                {"mean loss of JPO over BFGS's, lowest of any n (above)",
                 of<jpo_over_bfgs>,
                 asks_above(1)},
                {"JPO better, %",
                 of<better<false>>,
                 "jpo/navier-stokes table4/jpo/better"},
                {"refined better, %",
                 of<better<true>>,
                 "jpo/navier-stokes table5/jpo/better"}},
    .title = [](const Choice& choice) { return choice.title; },
    .experiment = [](const Choice& choice) { return choice.name(); },
    .seeds = kSeeds};

Table settings_table(const Evidence& e) {
  Table table{.id = "settings",
              .title = "BFGS and JPO by the unknowns that are bounded",
              .where = "Sec. 4, Tables 4 and 5",
              .corner = "through tanh",
              .note =
                  "BFGS: 32 problems a seed. JPO: means over n, then mean "
                  "± sample standard deviation over seeds. In brackets "
                  "what the text states."};
  return kStudy.rows(std::move(table), e);
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("columns_of_every_setting", kStudy.conditions());
  add_claims_of_folder(r, "jpo/flow_bounds", names);
  r.add_report(kChoices[0].name(), [](const Evidence& e) {
    return Section{.tables = {settings_table(e)}};
  });
}

}  // namespace physinv::flow_bounds
