// The pendulum by BFGS and by momentum, what is claimed of them, and a plot.
#include "momentum.h"
#include "optimizers/classical.h"
#include "pendulum.h"
#include "suite/evidence/claim.h"
#include "suite/harness/registry.h"
#include "suite/store/record.h"

namespace pendulum {
namespace {

std::vector<double> losses(const Run& run) {
  return {run.stage->loss.begin(), run.stage->loss.end()};
}

Quantity median_loss(const Select& runs) {
  return median_of_examples(runs, losses);
}

/// Medians of the losses over n, a line for each method.
Section draw(const Evidence& evidence) {
  Panel panel{.title = "",
              .x_label = "pendulums",
              .y_label = "median loss",
              .x_log = true,
              .y_log = true};
  for (const char* method : {"bfgs", "momentum"}) {
    Series series{.label = method, .method = method, .markers = true};
    for (const Index n : evidence.results.sizes("pendulum")) {
      const auto found = median_loss(Select{method}.of_sizes(n, n))(evidence);
      if (!found.value) continue;
      series.x.push_back(static_cast<double>(n));
      series.y.push_back(*found.value);
    }
    panel.series.push_back(series);
  }
  return {.figures = {{.id = "losses",
                       .title = "Final losses",
                       .where = "",
                       .panels = {panel},
                       .columns = 1}}};
}

const bool kRegistered = register_experiment({
    .name = "pendulum",
    .title = "Damped pendulum",
    .citation = {.paper = "pendulum", .where = "docs/extending.md"},
    .problem = pendulum(),
    .setting = {.gtol = 1e-8},
    .profiles = {{.name = "smoke",
                  .rows = {row({"bfgs", "momentum"}, 4, 1, 20)}},
                 {.name = "quick",
                  .rows = {row({"bfgs", "momentum"}, 8, 2),
                           row({"bfgs", "momentum"}, 32, 2)}}},
    .methods = {{"bfgs", {bfgs_solve()}}, {"momentum", {momentum_solve()}}},
    .claims = {{.id = "A1",
                .from = "quick",
                .says = "BFGS ends below momentum",
                .conditions = {below(
                    "BFGS / momentum",
                    ratio(median_loss({"bfgs"}), median_loss({"momentum"})),
                    1)}}},
    .styles = {{"bfgs", {Hue::blue, Marker::circle}},
               {"momentum", {Hue::orange, Marker::square}}},
    .report = draw,
});

}  // namespace
}  // namespace pendulum
