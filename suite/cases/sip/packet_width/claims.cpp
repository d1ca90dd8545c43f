// For which packets and networks the sentences of App. C.1 come out.
#include <string>
#include <utility>
#include <vector>

#include "suite/cases/sip/packet_width/settings.h"
#include "suite/cases/sip/wave_packet/values.h"
#include "suite/evidence/claim.h"
#include "suite/evidence/study_table.h"
#include "suite/harness/registry.h"

namespace physinv::packet_width {
namespace {

using sip_wave_packet::errors, sip_wave_packet::kBasin,
    sip_wave_packet::passes_lbfgs;

const Select kNet{"net"}, kLbfgs{"lbfgs"};

bool is_localized(double error) { return error <= kBasin; }

Quantity localized(const Select& who) {
  return percent(share_of_examples(who, errors(), is_localized));
}
Quantity of_both(RunValue value) {
  return depends_on(median(kNet, std::move(value)), {kLbfgs});
}
Quantity by_net(const Choice&) { return localized(kNet); }
Quantity by_lbfgs(const Choice&) { return localized(kLbfgs); }
Quantity updates_to_pass(const Choice&) { return of_both(passes_lbfgs()); }
Quantity loss_over_lbfgs(const Choice&) {
  return of_both(over(of_row(losses(), mean_of),
                      beside(kLbfgs, of_row(losses(), mean_of))));
}

const StudyTable<Choice> kStudy{
    .settings = choices(),
    .columns = {{"within half a period, % (most)", by_net, asks_above(50)},
                {"L-BFGS-B's, % (fewer)",
                 by_lbfgs,
                 [](std::string label, Quantity q, const Choice& c) {
                   return below(std::move(label),
                                std::move(q),
                                of_experiment(c.name(), by_net(c)));
                 }},
                {"updates to L-BFGS-B's loss (30 to 40)",
                 updates_to_pass,
                 [](std::string label, Quantity q, const Choice&) {
                   return at_most(
                       std::move(label),
                       std::move(q),
                       times(2, printed("sip/wave-packet crossing/latest")));
                 }},
                {"loss over L-BFGS-B's (below)",
                 loss_over_lbfgs,
                 asks_below(1)}},
    .title = [](const Choice& choice) { return choice.title(); },
    .experiment = [](const Choice& choice) { return choice.name(); }};

Claim claim() {
  return {.id = "S1",
          .from = "study",
          .says =
              "The network localizes most packets, more than L-BFGS-B, and "
              "passes its loss after 30 to 40 updates, whatever the "
              "packet's width and the network's norm, pooling and initial "
              "weights",
          .conditions = kStudy.conditions(),
          .cause = depends("width, norm, pooling and initial weights are not "
                           "printed, or ambiguously; the table has the "
                           "settings for which each number comes out")};
}

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
  const std::string first = choices().front().name();
  r.add_claims(first, {claim()});
  r.add_report(first, report);
}

}  // namespace physinv::packet_width
