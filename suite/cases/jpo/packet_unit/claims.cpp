// What claims.md asks for: numbers of each unit and of each rule, which tables
// show, too.
#include "suite/cases/common/claims.h"

#include <fmt/format.h>

#include <iterator>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "problems/wave_packet/wave_packet.h"
#include "suite/cases/jpo/common/values.h"
#include "suite/cases/jpo/packet_unit/settings.h"
#include "suite/cases/jpo/wave_packet/quantities.h"
#include "suite/evidence/study_table.h"

namespace physinv::packet_unit {
namespace {

constexpr Index kSeeds = 5;    ///< the paper's
constexpr double kOften = 20;  ///< per cent
constexpr double kBasin = 1;   ///< of the global optimum, in samples
const double kPeriod = 2 * std::numbers::pi / WavePacketOptions{}.frequency;
const Select kBfgs{"bfgs"};

// ---- numbers of a unit ------------------------------------------------------

RunRow of_pool(RunRow row) { return jpo::largest_sets(std::move(row)); }
Quantity pool_percent(const Select& runs,
                      RunRow row,
                      std::function<bool(double)> test) {
  return percent(
      share_of_examples(runs, of_pool(std::move(row)), std::move(test)));
}

Quantity large_steps(Index unit) {
  return pool_percent(
      kBfgs,
      jpo::wave_packet::first_steps_in(static_cast<double>(unit)),
      [](double d) { return d > kPeriod; });
}
Quantity iterations_of(const Select& runs) {
  return median_of_examples(runs, of_pool(iterations()));
}
template <bool kIsRefined, RunValue (*kShare)(Equality)>
Quantity share(Index) {
  return percent(depends_on(
      mean(kIsRefined ? jpo::kRefined : jpo::kJpo, kShare(Equality::strict)),
      {kBfgs}));
}

// ---- numbers of a rule ------------------------------------------------------

Select runs_of(const Choice& c) { return {c.rule->id}; }
double unit_of(const Choice& c) { return static_cast<double>(c.unit); }

Quantity misses(const Choice& c) {
  return pool_percent(runs_of(c),
                      jpo::wave_packet::distances_in(unit_of(c)),
                      [](double d) { return d > kBasin; });
}
Quantity more_iterations(const Choice& c) {
  return ratio(iterations_of(runs_of(c)), iterations_of(kBfgs));
}
template <int kSign>
Quantity closer_or_farther(const Choice& c) {
  return depends_on(
      pool_percent(runs_of(c),
                   jpo::wave_packet::farther_than_bfgs_in(unit_of(c)),
                   [](double d) { return kSign * d > 0; }),
      {kBfgs});
}
Quantity closer(const Choice& c) { return closer_or_farther<-1>(c); }
Quantity farther(const Choice& c) { return closer_or_farther<1>(c); }

std::vector<Choice> choices() {
  std::vector<Choice> all;
  for (const Index unit : kUnits)
    for (const Rule& rule : kRules) all.push_back({unit, &rule});
  return all;
}

// ---- columns ----------------------------------------------------------------

/// Of BFGS and JPO, for each unit.
const StudyTable<Index> kOfUnits{
    .settings = {std::begin(kUnits), std::end(kUnits)},
    .columns = {{"first steps of BFGS beyond a period, % (usually)",
                 large_steps,
                 asks_above(50)},
                {"JPO better, %",
                 share<false, jpo::better>,
                 "jpo/wave-packet table4/jpo/better"},
                {"equal, %",
                 share<false, jpo::equal>,
                 "jpo/wave-packet table4/jpo/equal"},
                {"refined better, %",
                 share<true, jpo::better>,
                 "jpo/wave-packet table5/jpo/better"},
                {"refined equal, %",
                 share<true, jpo::equal>,
                 "jpo/wave-packet table5/jpo/equal"}},
    .title = [](Index unit) { return fmt::format("{} samples", unit); },
    .experiment = name_of,
    .seeds = kSeeds};

/// Of gradient descent.
const StudyTable<Choice> kOfRules{
    .settings = choices(),
    .columns = {{"ends in other minima, % (often)", misses},
                {"median iterations over BFGS's (more)", more_iterations},
                {"closer than BFGS, % (more often)", closer},
                {"farther, %", farther}},
    .title = [](const Choice& choice) { return choice.title(); },
    .experiment = [](const Choice& choice) { return name_of(choice.unit); }};

std::vector<Condition> conditions(const Choice& choice) {
  const auto label = [&](const std::string& what) {
    return fmt::format("{}: {}", choice.title(), what);
  };
  const auto of = [&](Quantity (*number)(const Choice&)) {
    return of_experiment(name_of(choice.unit), number(choice));
  };
  return {
      above(label(kOfRules.columns[0].title), of(misses), kOften),
      above(label(kOfRules.columns[1].title), of(more_iterations), 1),
      above(
          label("closer than BFGS, over farther, %"), of(closer), of(farther))};
}

std::vector<Condition> of_every_rule() {
  std::vector<Condition> all;
  for (const Choice& choice : choices())
    for (Condition& c : conditions(choice)) all.push_back(std::move(c));
  return all;
}

// ---- report -----------------------------------------------------------------

Table by_unit(const Evidence& e) {
  Table table{.id = "units",
              .title = "BFGS and JPO by the unit of t0",
              .where = "Sec. 4, Tables 4 and 5",
              .corner = "samples in a unit",
              .note =
                  "First steps of 256 problems a seed; JPO: means over n, then "
                  "mean ± sample standard deviation over seeds."};
  StudyTable<Index> study = kOfUnits;
  study.title = [](Index unit) { return fmt::format("{}", unit); };
  return study.rows(std::move(table), e);
}

Table by_rule(const Evidence& e) {
  Table table{
      .id = "rules",
      .title = "Gradient descent by unit, rule and first step",
      .where = "Sec. 4",
      .corner = "unit, rule, first step",
      .note = "Of 256 problems a seed. In brackets what the text states."};
  return kOfRules.rows(std::move(table), e);
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("columns_of_every_unit", kOfUnits.conditions());
  names.set("sentences_of_every_rule", of_every_rule());
  add_claims_of_folder(r, "jpo/packet_unit", names);
  r.add_report(name_of(kUnits[0]), [](const Evidence& e) {
    return Section{.tables = {by_unit(e), by_rule(e)}};
  });
}

}  // namespace physinv::packet_unit
