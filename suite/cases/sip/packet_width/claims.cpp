// For which packets and networks the sentences of App. C.1 come out.
#include <fmt/format.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "suite/cases/sip/packet_width/settings.h"
#include "suite/cases/sip/wave_packet/values.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/claim.h"
#include "suite/evidence/of_experiment.h"
#include "suite/evidence/settings_table.h"
#include "suite/harness/registry.h"

namespace physinv::packet_width {
namespace {

using sip_wave_packet::errors, sip_wave_packet::kBasin, sip_wave_packet::losses,
    sip_wave_packet::mean_of, sip_wave_packet::passes_lbfgs;

const Select kNet{"net"}, kLbfgs{"lbfgs"};

bool is_localized(double error) { return error <= kBasin; }

Quantity localized(const Select& who, const Choice& c) {
  return of_experiment(c.name(),
                       percent(share_of_examples(who, errors(), is_localized)));
}
Quantity by_net(const Choice& c) { return localized(kNet, c); }
Quantity by_lbfgs(const Choice& c) { return localized(kLbfgs, c); }
Quantity of_both(const Choice& c, RunValue value) {
  return of_experiment(c.name(),
                       depends_on(median(kNet, std::move(value)), {kLbfgs}));
}
Quantity updates_to_pass(const Choice& c) { return of_both(c, passes_lbfgs()); }
Quantity loss_over_lbfgs(const Choice& c) {
  return of_both(c, over(mean_of(losses()), beside(kLbfgs, mean_of(losses()))));
}

/// A number of each setting, and what the text asks of it.
struct Column {
  const char* title;
  Quantity (*of)(const Choice&);
  Condition (*asks)(std::string, const Choice&);
};
constexpr Column kColumns[] = {
    {"within half a period, % (most)",
     by_net,
     [](std::string label, const Choice& c) {
       return above(std::move(label), by_net(c), 50);
     }},
    {"L-BFGS-B's, % (fewer)",
     by_lbfgs,
     [](std::string label, const Choice& c) {
       return below(std::move(label), by_lbfgs(c), by_net(c));
     }},
    {"updates to L-BFGS-B's loss (30 to 40)",
     updates_to_pass,
     [](std::string label, const Choice& c) {
       return at_most(std::move(label),
                      updates_to_pass(c),
                      times(2, printed("sip/wave-packet crossing/latest")));
     }},
    {"loss over L-BFGS-B's (below)",
     loss_over_lbfgs,
     [](std::string label, const Choice& c) {
       return below(std::move(label), loss_over_lbfgs(c), 1);
     }}};

Condition condition(const Choice& choice, const Column& c) {
  return c.asks(fmt::format("{}: {}", choice.title(), c.title), choice);
}

std::vector<Condition> all_settings() {
  std::vector<Condition> all;
  for (const Choice& choice : choices())
    for (const Column& c : kColumns) all.push_back(condition(choice, c));
  return all;
}

Claim claim() {
  return {.id = "S1",
          .from = "study",
          .says =
              "The network localizes most packets, more than L-BFGS-B, and "
              "passes its loss after 30 to 40 updates, whatever the "
              "packet's width and the network's norm, pooling and initial "
              "weights",
          .conditions = all_settings(),
          .cause = depends("width, norm, pooling and initial weights are not "
                           "printed, or ambiguously; the table has the "
                           "settings for which each number comes out")};
}

Section report(const std::string& name,
               const Results& results,
               const Published& published) {
  const Evidence evidence{results, published, name};
  Table table{.id = "settings",
              .title = "Packets localized by width and network",
              .where = "App. C.1, Fig. 16",
              .corner = "variance, norm, pooling, initial weights",
              .note =
                  "Shares of all test examples ± sample standard deviation "
                  "over seeds, medians over seeds of the others. In "
                  "brackets what the text states."};
  std::vector<Choice> run = choices();
  std::erase_if(run, [&](const Choice& choice) {
    return find_runs(evidence, kNet.in(choice.name())).empty();
  });
  return {.tables = {table_by_setting(
              std::move(table),
              run,
              kColumns,
              [](const Choice& choice) { return choice.title(); },
              [&](const Choice& choice, const Column& c) {
                return written(c.of(choice)(evidence));
              })}};
}

}  // namespace

void add_claims(Registry& r) {
  const std::string first = choices().front().name();
  r.add_claims(first, {claim()});
  r.add_report(first, [first](const Results& results, const Published& p) {
    return report(first, results, p);
  });
}

}  // namespace physinv::packet_width
