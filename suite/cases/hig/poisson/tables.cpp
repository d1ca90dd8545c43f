#include "suite/cases/hig/poisson/tables.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace physinv::poisson {
namespace {

/// Since when the smaller rate leads, up to the end of the larger one's curve.
Cell crossing(const Runs& runs, const char* smaller, const char* larger) {
  const auto some = runs.all(larger, "adam");
  if (some.empty()) return {.text = "not run"};
  std::optional<double> since;
  double last = 0;
  for (const double updates : some.front()->curve.iteration) {
    const auto a = runs.loss(smaller, updates), b = runs.loss(larger, updates);
    // Behind a first stretch in which every curve falls alike.
    if (!a || !b || updates < 100) continue;
    last = updates;
    if (*a >= *b) since.reset();
    if (*a < *b && !since) since = updates;
  }
  if (since) return {.ours = since};
  if (last > 0) return {.text = fmt::format("not within {}", last)};
  return {.text = "not run"};
}

}  // namespace

Table spectrum_table(const Runs& runs) {
  Table table{.id = "spectra",
              .title = "Singular values of the stacked Jacobian",
              .source = "App. B.3",
              .digits = 0,
              .corner = "method",
              .columns = {"rows m",
                          "updates seen",
                          "least kept",
                          "smallest s / s_max",
                          "unproven"},
              .note =
                  "Over all seeds. The cut is 1e-5 s_max. Gauss-Newton by a "
                  "Cholesky factorisation knows that all s are above the cut, "
                  "not where. Unproven: updates whose accuracy was not "
                  "shown."};
  for (const Phase& p : phases(runs)) {
    const auto number = [](Index v) {
      return Cell{.ours = static_cast<double>(v)};
    };
    table.rows.push_back(
        {.label = p.method,
         .cells = {number(p.rows),
                   number(p.updates),
                   number(p.least_kept),
                   Cell{.text = std::isfinite(p.smallest)
                                    ? fmt::format("{:.1e}", p.smallest)
                                    : "above the cut"},
                   number(p.unproven)}});
  }
  return table;
}

Table crossing_table(const Runs& runs) {
  Table table{.id = "crossings",
              .title = "From when on the smaller of two of Adam's rates leads",
              .source = "Figs. 3b, 7a",
              .digits = 0,
              .corner = "rates",
              .columns = {"updates"},
              .note = "Medians over seeds, at the measured points."};
  struct Pairing {
    const char *label, *smaller, *larger;
  };
  for (const Pairing& p : {Pairing{"1e-4, 3e-4", "adam", "adam-3e-4"},
                           Pairing{"1e-4, 1e-3", "adam", "adam-1e-3"},
                           Pairing{"3e-4, 1e-3", "adam-3e-4", "adam-1e-3"}}) {
    table.rows.push_back(
        {.label = p.label, .cells = {crossing(runs, p.smaller, p.larger)}});
  }
  return table;
}

}  // namespace physinv::poisson
