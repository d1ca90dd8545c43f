#include <fmt/format.h>

#include <string>
#include <utility>

#include "suite/cases/common/update_time.h"
#include "suite/cases/hig/jacobian_times/jacobian_times.h"
#include "suite/harness/registry.h"

namespace physinv::hig::jacobian_times {
namespace {

Section report(const Timed& t,
               const Results& results,
               const Published& published) {
  const Evidence ours{results, published, name_of(t.experiment)};
  Table table{.id = "jacobians",
              .title = "Duration of the Jacobian",
              .where = t.table,
              .unit = "CPU ms",
              .digits = 3,
              .corner = "optimizer",
              .columns = {"Jacobian"}};
  TimedStages timed;
  for (const Batches& b : {t.adam, t.hig})
    for (const Index batch : b.sizes) {
      Cell cell = update_time(ours, {b.method(batch)}, timed);
      if (const auto value = published.find(
              t.experiment,
              fmt::format("{}/{}/b={}/jacobian", t.key, b.optimizer, batch)))
        cell.paper = 1e3 * value->value;
      table.rows.push_back({.label = fmt::format("{}, b = {}", b.title, batch),
                            .cells = {std::move(cell)}});
    }
  table.note =
      "The gradient of a batch for Adam; for HIG the Jacobians of solver and "
      "outputs, the network's is not formed. " +
      timed.note() + " The paper's machine had a GPU.";
  return {.tables = {std::move(table)}};
}

}  // namespace

void add_reports(Registry& r) {
  for (const Timed& t : kTimed)
    r.add_report(name_of(t.experiment),
                 [&t](const Results& results, const Published& published) {
                   return report(t, results, published);
                 });
}

}  // namespace physinv::hig::jacobian_times
