// What claims.md asks of runs, and what an update takes (Fig. 15).
#include "suite/cases/common/claims.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "suite/evidence/training.h"
#include "suite/evidence/training_report.h"
#include "suite/evidence/update_time.h"
#include "suite/harness/registry.h"
#include "suite/store/record.h"

namespace physinv::sip::overview {
namespace {

/// Of runs with ten updates looked at or more.
std::vector<double> update_cosines(const Run& run) {
  const auto found = run.stage->arrays.find("update_cosine");
  if (found == run.stage->arrays.end() || found->second.size() < 10) return {};
  return {found->second.data(), found->second.data() + found->second.size()};
}

// ---- what an update takes ---------------------------------------------------

/// Columns; a method that is called otherwise has its own id in a row.
struct Column {
  const char *id, *title;
  Hue hue;
};
constexpr Column kColumns[] = {{"sip", "SIP", Hue::orange},
                               {"adam", "Adam", Hue::purple},
                               {"sgd", "SGD", Hue::brown},
                               {"adahessian", "AdaHessian", Hue::teal},
                               {"hf", "Hessian-free", Hue::grey}};

/// One batch size of an experiment, the suffix of its methods.
struct Setting {
  const char *experiment, *title, *suffix;
  const char *sip = "sip", *hf = "hf";

  std::string method(const Column& c) const {
    const std::string id = c.id;
    return (id == "sip" ? sip : id == "hf" ? hf : id) + std::string(suffix);
  }
};
constexpr Setting kSettings[] = {
    {"sip/exponential", "Exponential, batch 100", "", "norm"},
    {"sip/sine-xi32-phi45", "Sine, batch 100", ""},
    {"sip/poisson", "Poisson, batch 128", ""},
    {"sip/poisson", "Poisson, batch 8", "-b8", "sip", "hf-40"},
    {"sip/heat", "Heat, batch 128", ""},
    {"sip/heat", "Heat, batch 8", "-b8"},
    {"sip/fluid", "Fluid, batch 64", ""},
    {"sip/fluid", "Fluid, batch 16", "-b16"}};

Table table_of(const Evidence& e) {
  Table table{.id = "fig15",
              .title = "CPU time of an update",
              .where = "Fig. 15",
              .unit = "ms",
              .digits = 2,
              .corner = "experiment",
              .across = Across{.key = "method", .quantities = {"time"}}};
  TimedStages timed;
  for (const Column& c : kColumns) table.columns.push_back(c.title);
  for (const Setting& s : kSettings) {
    TableRow row{.label = s.title};
    for (const Column& c : kColumns)
      row.cells.push_back(
          update_time(e, Select{s.method(c)}.in(s.experiment), timed));
    if (std::any_of(row.cells.begin(), row.cells.end(), [](const Cell& cell) {
          return cell.text != kNotRun;
        }))
      table.rows.push_back(std::move(row));
  }
  table.note =
      "Medians over seeds, without what draws the examples. The exponential's "
      "SIP has normalized gradients. " +
      timed.note();
  return table;
}

/// A panel for each experiment.
Figure figure_of(const Evidence& e) {
  Figure figure{.id = "fig15_batches",
                .title = "What an update takes",
                .where = "Fig. 15",
                .columns = 3};
  std::vector<std::string> drawn;
  for (const Setting& first : kSettings) {
    if (std::count(drawn.begin(), drawn.end(), first.experiment) > 0) continue;
    drawn.emplace_back(first.experiment);
    std::vector<MethodLine> lines;
    for (const Setting& s : kSettings)
      if (drawn.back() == s.experiment)
        for (const Column& c : kColumns)
          lines.push_back({s.method(c), c.title, c.hue});
    Figure own = update_times(e.of(first.experiment), lines, figure.where);
    Panel& panel = own.panels.front();
    if (panel.series.empty()) continue;
    panel.title =
        std::string(first.title).substr(0, std::string(first.title).find(','));
    figure.panels.push_back(std::move(panel));
    figure.note = own.note;
  }
  return figure;
}

Section step_times(const Evidence& e) {
  Section section;
  // One experiment has no others to be compared with.
  if (Table table = table_of(e); table.rows.size() > 1)
    section.tables.push_back(std::move(table));
  if (Figure figure = figure_of(e); !figure.panels.empty())
    section.figures.push_back(std::move(figure));
  return section;
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("update_cosines", update_cosines);
  r.add(
      Overview{.paper = "sip",
               .title = "Scale-invariant learning",
               .profiles = {"smoke", "quick", "standard", "paper"},
               .claims = claims_of_folder("sip/overview", names).front().claims,
               .report = step_times});
}

}  // namespace physinv::sip::overview
