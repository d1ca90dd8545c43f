// What claims.md asks for: numbers of each wall, which a table shows, too.
#include "suite/cases/common/claims.h"

#include <fmt/format.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "suite/cases/jpo/adjoint_wall/settings.h"
#include "suite/cases/jpo/common/values.h"
#include "suite/evidence/cell.h"

namespace physinv::adjoint_wall {
namespace {

constexpr Index kSeeds = 4;  ///< the fewest that the paper has of any
constexpr double kMargin = 0.02, kMany = 0.2;

struct Column {
  const char* title;
  bool refined;
  RunValue (*share)(Equality);
  const char* printed;
};
constexpr Column kColumns[] = {
    {"better", false, jpo::better, "table4/na/better"},
    {"equal", false, jpo::equal, "table4/na/equal"},
    {"refined better", true, jpo::better, "table5/na/better"},
    {"refined equal", true, jpo::equal, "table5/na/equal"}};

std::string printed_name(const Study& s, const Column& c) {
  return std::string(s.varied) + ' ' + c.printed;
}

Quantity percent_of(const Wall& w, const Column& c) {
  const Select runs{w.method(), c.refined ? "refine" : "solve"};
  return percent(mean(runs, c.share(Equality::strict)));
}

/// Of the problems whose paths are kept, at the largest n. The registry has the
/// study's problem once all are registered.
Quantity at_the_wall(const Study& s, const Wall& w) {
  const Select runs{w.method(), "solve"};
  const auto beyond = std::make_shared<RunRow>();
  return {[=](const Evidence& e) {
            if (!*beyond)
              *beyond = jpo::largest_sets(jpo::beyond_training(
                  registry().find(s.name)->problem, kMargin, s.labels));
            return share_of_examples(runs, *beyond, jpo::holds)(e);
          },
          {runs}};
}

Condition as_printed(const Study& s, const Wall& w, const Column& c) {
  return physinv::as_printed(fmt::format("{}: {}, %", w.title, c.title),
                             percent_of(w, c),
                             printed_name(s, c),
                             kSeeds);
}

std::vector<Condition> all_walls(const Study& s) {
  std::vector<Condition> all;
  for (const Wall& w : kWalls) {
    for (const Column& c : kColumns) all.push_back(as_printed(s, w, c));
    all.push_back(
        at_least(fmt::format("{}: share of ends at the wall", w.title),
                 at_the_wall(s, w),
                 kMany));
  }
  return all;
}

Section report(const Study& s, const Evidence& e) {
  Table table{.id = "walls",
              .title =
                  "Neural adjoint against BFGS by sharpness and weight "
                  "of the wall",
              .where = "Tables 4 and 5",
              .unit = "%",
              .corner = "sharpness, weight",
              .note =
                  "Means over n, then mean ± sample standard deviation "
                  "over seeds; ends within 2 % of the training range's "
                  "ends, or beyond, of the problems whose paths are kept "
                  "at the largest n."};
  for (const Column& c : kColumns) table.columns.push_back(c.title);
  table.columns.push_back("at the wall");
  for (const Wall& w : kWalls) {
    TableRow row{.label = w.title};
    for (const Column& c : kColumns) {
      row.cells.push_back(
          beside_printed(cell_of(percent_of(w, c)(e)), e, printed_name(s, c)));
    }
    row.cells.push_back(cell_of(percent(at_the_wall(s, w))(e)));
    table.rows.push_back(std::move(row));
  }
  return {.tables = {std::move(table)}};
}

}  // namespace

void add_claims(Registry& r) {
  for (const Study& s : kStudies) {
    ClaimNames names = claim_names();
    names.set("every_wall", all_walls(s));
    add_claims_of_experiment(r, "jpo/adjoint_wall", s.name, names);
    r.add_report(s.name, std::bind_front(report, s));
  }
}

}  // namespace physinv::adjoint_wall
