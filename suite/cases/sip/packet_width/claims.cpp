#include "suite/cases/common/claims.h"

#include <string>
#include <utility>
#include <vector>

#include "suite/cases/sip/packet_width/settings.h"
#include "suite/cases/sip/wave_packet/values.h"
#include "suite/evidence/study_table.h"

namespace physinv::packet_width {
namespace {

using sip_wave_packet::errors, sip_wave_packet::kBasin,
    sip_wave_packet::passes_lbfgs;

const Select kNet{"net"}, kLbfgs{"lbfgs"};

Quantity localized(const Select& who) {
  return percent(share_of_examples(
      who, errors(), [](double error) { return error <= kBasin; }));
}
Quantity by_net(const Choice&) { return localized(kNet); }
Quantity by_lbfgs(const Choice&) { return localized(kLbfgs); }
Quantity updates_to_pass(const Choice&) {
  return depends_on(median(kNet, passes_lbfgs()), {kLbfgs});
}
Quantity loss_over_lbfgs(const Choice&) {
  const RunValue loss = of_row(losses(), mean_of);
  return depends_on(median(kNet, over(loss, beside(kLbfgs, loss))), {kLbfgs});
}

const StudyTable<Choice> kStudy{
    .settings = choices(),
    .columns = {{"within half a period, % (most)", by_net, asks_above(50)},
                {"L-BFGS-B's, % (fewer)",
                 by_lbfgs,
                 [](std::string label, Quantity q, const Choice& c) {
                   return below(
                       std::move(label), q, of_experiment(c.name(), by_net(c)));
                 }},
                {"updates to L-BFGS-B's loss (30 to 40)",
                 updates_to_pass,
                 [](std::string label, Quantity q, const Choice&) {
                   return at_most(
                       std::move(label),
                       q,
                       times(2, printed("sip/wave-packet crossing/latest")));
                 }},
                {"loss over L-BFGS-B's (below)",
                 loss_over_lbfgs,
                 asks_below(1)}},
    .title = &Choice::title,
    .experiment = &Choice::name};

Section report(const Evidence& evidence) {
  Table table{.id = "settings",
              .title = "Packets localized by width and network",
              .where = "App. C.1, Fig. 16",
              .corner = "variance, norm, pooling, initial weights",
              .note =
                  "Shares of all test examples ± sample standard deviation "
                  "over seeds, medians over seeds of the others. In "
                  "brackets what the text states."};
  StudyTable<Choice> run = kStudy;
  std::erase_if(run.settings, [&](const Choice& choice) {
    return find_runs(evidence, kNet.in(choice.name())).empty();
  });
  return {.tables = {run.rows(std::move(table),
                              evidence,
                              [](const Measured& m) { return written(m); })}};
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("columns_of_every_setting", kStudy.conditions());
  add_claims_of_folder(r, "sip/packet_width", names);
  r.add_report(choices().front().name(), report);
}

}  // namespace physinv::packet_width
