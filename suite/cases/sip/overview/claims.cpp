// What the SIP paper says of its experiments together (App. A.2, B, Fig. 15).
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

Condition update(const std::string& what,
                 const std::string& experiment,
                 const std::string& sip,
                 const std::string& adam) {
  return of_stages(within(what + ", CPU time of SIP over Adam",
                          median_ratio(Select{sip}.in(experiment),
                                       Select{adam}.in(experiment),
                                       seconds_per_update()),
                          0.9,
                          1.1));
}

/// Of runs with ten updates looked at or more.
std::vector<double> update_cosines(const Run& run) {
  const auto found = run.stage->arrays.find("update_cosine");
  if (found == run.stage->arrays.end() || found->second.size() < 10) return {};
  return {found->second.data(), found->second.data() + found->second.size()};
}

Condition same_way(const std::string& what,
                   const std::string& experiment,
                   const std::string& method) {
  return above(what,
               share_of_examples(Select{method}.in(experiment),
                                 update_cosines,
                                 [](double cosine) { return cosine > 0; }),
               0.5);
}

const std::vector<Claim> kClaims = {
    {.id = "P1",
     .where = "Fig. 15",
     .from = "quick",
     .says = "The choice of the gradient changes the time of training by less "
             "than 10 %",
     .conditions = {update(
                        "Poisson, batch 8", "sip/poisson", "sip-b8", "adam-b8"),
                    update("heat, batch 8", "sip/heat", "sip-b8", "adam-b8"),
                    update(
                        "fluid, batch 16", "sip/fluid", "sip-b16", "adam-b16"),
                    update("sine", "sip/sine-xi32-phi45", "sip", "adam")},
     .note = "The paper's batches are of 128, its clock that of a GPU; ours is "
             "CPU time, of stages that shared no core.",
     .cause = contradiction(
         "App. B.1 has more than 50,000 updates in ten minutes, about "
         "15,000 of SIP: 3.3 times the time, Fig. 15 less than 1.1"),
     .gates = false},
    {.id = "P2",
     .where = "App. A.2",
     .from = "standard",
     .says =
         "Updates of the weights do not systematically distort the direction "
         "in x",
     .conditions = {same_way("sine", "sip/sine-xi32-phi45", "sip-cosines"),
                    same_way("exponential", "sip/exponential", "norm-cosines"),
                    same_way(
                        "Poisson, batch 8", "sip/poisson", "sip-cosines-b8"),
                    same_way("heat, batch 8", "sip/heat", "sip-cosines-b8")},
     .note = "The mean change of a batch's estimates by its update, and the "
             "mean that the inverse asks for: the share of the updates with an "
             "acute angle between them."}};

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
  r.add(Overview{.paper = "sip",
                 .title = "Scale-invariant learning",
                 .profiles = {"smoke", "quick", "standard", "paper"},
                 .claims = kClaims,
                 .report = step_times});
}

}  // namespace physinv::sip::overview
