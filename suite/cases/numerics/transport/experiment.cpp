// How fluids are carried: energy over a thousand steps, order of the advection.
#include <string>
#include <utility>
#include <vector>

#include "problems/marker_flow/marker_flow.h"
#include "suite/cases/numerics/transport/transport.h"
#include "suite/harness/registry.h"

namespace physinv::numerics::transport {
namespace {

constexpr const char* kName = "numerics/transport";

const Row kRow{.methods = {"carry"}, .n = {1}, .seeds = {0}};

// ---- pages ----------------------------------------------------------------

const StageRecord* find(const Evidence& e, const std::string& stage) {
  for (const CaseRecord& c : e.results.cases())
    if (c.info.experiment == kName)
      for (const StageRecord& s : c.stages)
        if (s.stage == stage && !s.arrays.empty()) return &s;
  return nullptr;
}

/// A row of an array over another's, without what has no number.
Series over(const StageRecord& s,
            ArrayKey x,
            ArrayKey array,
            Index row,
            std::string label) {
  Series out{
      .label = std::move(label), .method = array.text(), .markers = true};
  const auto &at = s.arrays.at(x), &values = s.arrays.at(array);
  for (Index k = 0; k < at.cols(); ++k)
    if (values(row, k) >= 0)
      out.x.push_back(at(0, k)), out.y.push_back(values(row, k));
  return out;
}

Figure drift_figure(const StageRecord& s) {
  const auto panel = [&](const char* title, bool log) {
    return Panel{.title = title, .x_label = "step", .y_log = log};
  };
  Panel energy = panel("|E - E(0)| / E(0)", true),
        left = panel("Energy left without scaling", false),
        out = panel("Net flow out of a cell, relative", true);
  const auto add = [&](Panel& to, ArrayKey array, const char* label) {
    for (Index i = 0; i < s.arrays.at(array).rows(); ++i) {
      Series one = over(s, "step", array, i, i == 0 ? label : "");
      one.method = label, one.markers = false;
      to.series.push_back(std::move(one));
    }
  };
  add(energy, "energy", "double"), add(energy, "energy_single", "float");
  add(left, "unscaled", "double"), add(out, "divergence", "double");
  return {.id = "energy",
          .title = "A thousand steps of a periodic flow",
          .panels = {energy, left, out},
          .columns = 3,
          .note = "Four flows as the experiment draws them, 32 x 32 cells."};
}

Figure order_figure(const StageRecord& s) {
  Panel panel{.x_label = "cells a side",
              .y_label = "error",
              .x_log = true,
              .y_log = true,
              .series = {over(s, "cells", "constant", 0, "constant velocity"),
                         over(s, "cells", "shear", 0, "shear"),
                         over(s, "cells", "free", 0, "one step, not limited")}};
  return {.id = "order",
          .title = "MacCormack advection of a smooth field",
          .panels = {std::move(panel)},
          .columns = 1,
          .note =
              "Half a cell a step. Root mean squares at t = 1/2; of one "
              "step the largest error where the limiter does not act."};
}

Section report(const Evidence& e) {
  Section section;
  if (const auto* s = find(e, "energy"))
    section.figures.push_back(drift_figure(*s));
  if (const auto* s = find(e, "order"))
    section.figures.push_back(order_figure(*s));
  return section;
}

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{.name = kName,
                   .title = "Numerics of carried fields",
                   .citation = {.paper = "sip", .where = "App. B.4"},
                   .problem = problems::marker_flow({.cells = 32}),
                   .setting = {},
                   .profiles = {{.name = "smoke", .rows = {kRow}},
                                {.name = "quick", .rows = {kRow}},
                                {.name = "paper", .rows = {kRow}}},
                   .methods = {{"carry", {energy_drift(), advection_order()}}},
                   .report = report});
}

}  // namespace physinv::numerics::transport
