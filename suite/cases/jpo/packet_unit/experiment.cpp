// JPO paper, Sec. 4 "Wave packet localization": the unit that t0 is counted in,
// rule and first step of gradient descent are not printed. The unit decides how
// far a step goes. An experiment for each unit.
#include "optimizers/classical.h"
#include "optimizers/jpo.h"
#include "suite/cases/jpo/packet_unit/settings.h"
#include "suite/cases/jpo/wave_packet/setting.h"
#include "suite/harness/registry.h"
#include "suite/harness/study.h"

namespace physinv::packet_unit {
namespace {

constexpr Index kFit = 3000;

Method descent(const Rule& rule) {
  return {
      .id = rule.id,
      .chain = {rule.bold
                    ? bold_descent_solve({.first_step = rule.first_step})
                    : gradient_descent_solve({.first_step = rule.first_step})}};
}

Experiment experiment(Index unit) {
  Experiment e{
      .name = name_of(unit),
      .title = fmt::format("Wave packet, units of {} samples", unit),
      .citation = {.paper = "jpo", .where = "Sec. 4, Tables 4 and 5"},
      .problem = jpo::wave_packet::recipe(static_cast<double>(unit)),
      .setting = jpo::wave_packet::setting(),
      .methods = {{.id = "bfgs", .chain = {bfgs_solve()}},
                  {.id = "jpo",
                   .chain = {jpo_fit({.step = AdamOptions{.rate = 1e-3},
                                      .iterations = kFit}),
                             bfgs_refine()}}}};
  Row classical{
      .methods = {"bfgs"}, .n = {8, 32, 256}, .seeds = first_seeds(3)};
  for (const Rule& rule : kRules) {
    e.methods.push_back(descent(rule));
    classical.methods.push_back(rule.id);
  }
  const Row trained{.methods = {"jpo"},
                    .n = {8, 32},
                    .seeds = first_seeds(3),
                    .iterations = kFit};
  e.profiles = {{.name = "study", .rows = {classical, trained}}};
  return e;
}

}  // namespace

void add_experiments(Registry& r) {
  for (const Index unit : kUnits) {
    register_study(name_of(unit), "jpo/wave-packet");
    r.add(experiment(unit));
  }
}

}  // namespace physinv::packet_unit
