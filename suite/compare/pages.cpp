#include "suite/compare/pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "suite/results/profiles.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

Cell number(double value, const char* format) {
  return std::isfinite(value)
             ? Cell{.ours = value,
                    .text = fmt::format(fmt::runtime(format), value)}
             : Cell{.text = "not finite"};
}

/// As a factor, with every digit for programs.
Cell factor(double a, double b) {
  if (a == b) return {.ours = 1.0, .text = "="};
  if (!(a > 0) || !std::isfinite(b / a)) return {.text = "–"};
  const double r = b / a;
  return number(r, r >= 0.01 && r < 1000 ? "×{:.3g}" : "×{:.1e}");
}

std::string joined(const std::map<std::string, Index>& counts) {
  std::string out;
  for (const auto& [word, count] : counts)
    if (count > 0)
      out += fmt::format("{}{} {}", out.empty() ? "" : ", ", count, word);
  return out;
}

/// The word alone if all agree.
std::string ends_text(const Reading& r) {
  return r.ends.size() == 1 ? r.ends.begin()->first : joined(r.ends);
}

Cell bits(const Reading& r) {
  return {.text = r.same_bits == r.stages
                      ? "same"
                      : fmt::format("{} of {}", r.same_bits, r.stages)};
}

Cell ends_cell(const Compared& row, std::size_t s) {
  const auto& a = row.sides.front();
  const auto& b = row.sides[s];
  if (!b) return {.text = "missing"};
  return {.text = !a || a->ends == b->ends
                      ? ends_text(*b)
                      : ends_text(*a) + " → " + ends_text(*b)};
}

/// One cell per side.
template <class F>
void add_sides(TableRow& row, const Compared& c, F&& cell) {
  for (const auto& r : c.sides)
    row.cells.push_back(r ? cell(*r) : Cell{.text = "missing"});
}

/// A side's reading against the first's.
template <class F>
Cell against(const Compared& c, std::size_t s, F&& cell) {
  return c.sides.front() && c.sides[s] ? cell(*c.sides.front(), *c.sides[s])
                                       : Cell{.text = "–"};
}

template <class F>
Table per_side(const Comparison& c,
               const char* id,
               const char* title,
               const char* unit,
               F&& cell) {
  Table table{.id = id,
              .title = title,
              .unit = unit,
              .digits = 3,
              .corner = "stage",
              .columns = c.labels};
  for (const Compared& row : c.rows) {
    table.rows.push_back({row.id.text(), {}});
    add_sides(table.rows.back(), row, cell);
  }
  return table;
}

Comparison of_experiment(const Comparison& all, const std::string& name) {
  Comparison own{all.labels, {}};
  for (const auto& row : all.rows)
    if (row.id.experiment == name) own.rows.push_back(row);
  return own;
}

/// Loss over time of every method and side: a point per stage or group.
Figure overlay(const Comparison& c) {
  Figure figure{.id = "work_precision",
                .title = "Loss over time of solving",
                .columns = 1};
  Panel panel{.x_label = "seconds",
              .y_label = "median loss",
              .x_log = true,
              .y_log = true};
  std::map<std::string, Series> series;
  for (const Compared& row : c.rows) {
    for (std::size_t s = 0; s < row.sides.size(); ++s) {
      if (!row.sides[s]) continue;
      const std::string label = row.id.method + ", " + c.labels[s];
      Series& own = series[label];
      own.label = own.method = label;
      own.line = false, own.markers = true;
      own.x.push_back(row.sides[s]->seconds);
      own.y.push_back(row.sides[s]->loss);
    }
  }
  for (auto& [label, own] : series) panel.series.push_back(std::move(own));
  figure.panels.push_back(std::move(panel));
  return figure;
}

Section overview(const Comparison& c,
                 const std::vector<ChangedClaim>& changed) {
  Section section{.experiment = "compare",
                  .title = fmt::format("What changed from {}", c.labels[0])};
  section.tables.push_back(changes_table(c, 40));
  if (!changed.empty())
    section.tables.push_back(claims_table(changed, c.labels));
  return section;
}

Json to_json(const Reading& r) {
  Json counts = Json::object();
  for (std::size_t i = 0; i < kCounters; ++i)
    counts[std::string(kCounterNames[i])] = r.counts[static_cast<Counter>(i)];
  const Json loss = std::isfinite(r.loss) ? Json(r.loss) : Json(nullptr);
  return {{"stages", r.stages},
          {"same_bits", r.same_bits},
          {"loss_median", loss},
          {"seconds", r.seconds},
          {"iterations", r.iterations},
          {"ends", r.ends},
          {"statuses", r.states},
          {"counts", std::move(counts)}};
}

std::string word(const ClaimResult& claim) {
  return std::string(words_of(claim.verdict, claim.origin));
}

}  // namespace

Table changes_table(const Comparison& c, std::size_t most) {
  Table table{.id = "changes", .title = "What changed most", .corner = "stage"};
  for (const auto& label : c.labels) table.columns.push_back("loss " + label);
  for (std::size_t s = 1; s < c.labels.size(); ++s)
    for (const char* what :
         {"loss", "time", "simulations", "passes", "end", "bits"})
      table.columns.push_back(c.labels.size() == 2
                                  ? std::string(what)
                                  : fmt::format("{} {}", what, c.labels[s]));
  for (const Compared& row : c.rows) {
    if (table.rows.size() == most) break;
    TableRow out{row.id.text(), {}};
    add_sides(
        out, row, [](const Reading& r) { return number(r.loss, "{:.2e}"); });
    for (std::size_t s = 1; s < c.labels.size(); ++s) {
      const auto add = [&](auto&& cell) {
        out.cells.push_back(against(row, s, cell));
      };
      add([](auto& a, auto& b) { return factor(1, loss_ratio(a, b)); });
      add([](auto& a, auto& b) { return factor(a.seconds, b.seconds); });
      add([](auto& a, auto& b) {
        return factor(a.simulations(), b.simulations());
      });
      add([](auto& a, auto& b) { return factor(a.passes(), b.passes()); });
      out.cells.push_back(ends_cell(row, s));
      add([](auto&, auto& b) { return bits(b); });
    }
    table.rows.push_back(std::move(out));
  }
  if (c.rows.size() > most)
    table.note =
        fmt::format("{} more lines changed less", c.rows.size() - most);
  return table;
}

std::vector<Table> detail_tables(const Comparison& c) {
  std::vector<Table> tables;
  tables.push_back(
      per_side(c, "times", "Times of solving", "ms", [](const Reading& r) {
        return number(1e3 * r.seconds, "{:.4g}");
      }));
  tables.push_back(
      per_side(c, "statuses", "How examples ended", "", [](const Reading& r) {
        return Cell{.text = joined(r.states)};
      }));
  tables.push_back(
      per_side(c, "iterations", "Iterations", "", [](const Reading& r) {
        return number(static_cast<double>(r.iterations), "{:.0f}");
      }));
  for (std::size_t i = 0; i < kCounters; ++i) {
    const auto counter = static_cast<Counter>(i);
    const auto uses = [&](const Compared& row) {
      return std::any_of(row.sides.begin(), row.sides.end(), [&](auto& r) {
        return r && r->counts[counter] > 0;
      });
    };
    if (std::none_of(c.rows.begin(), c.rows.end(), uses)) continue;
    const std::string name(kCounterNames[i]);
    tables.push_back(
        per_side(c, name.c_str(), name.c_str(), "", [&](const Reading& r) {
          return number(static_cast<double>(r.counts[counter]), "{:.0f}");
        }));
  }
  return tables;
}

Table claims_table(const std::vector<ChangedClaim>& changed,
                   const std::vector<std::string>& labels) {
  Table table{.id = "claims",
              .title = "Claims whose verdict changed",
              .corner = "claim",
              .columns = labels};
  for (const ChangedClaim& c : changed) {
    TableRow row;
    for (const auto& side : c.sides) {
      if (side && row.label.empty())
        row.label =
            fmt::format("{} {}: {}", c.experiment, side->id, side->says);
      row.cells.push_back({.text = word(side.value_or(ClaimResult{}))});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<Section> compare_sections(
    const Comparison& c,
    const std::vector<Side>& sides,
    const std::vector<ChangedClaim>& changed) {
  std::vector<Section> sections = {overview(c, changed)};
  std::set<std::string> names;
  for (const auto& row : c.rows) names.insert(row.id.experiment);
  const Results all = pooled(sides);
  for (const auto& name : names) {
    const Comparison own = of_experiment(c, name);
    Section section{.experiment = name, .title = name};
    section.tables.push_back(changes_table(own, own.rows.size()));
    for (auto& table : detail_tables(own))
      section.tables.push_back(std::move(table));
    section.figures.push_back(overlay(own));
    for (auto& figure :
         profile_figures(all, name, {.title = name, .method_titles = {}}))
      section.figures.push_back(std::move(figure));
    sections.push_back(std::move(section));
  }
  return sections;
}

Json to_json(const Comparison& c, const std::vector<ChangedClaim>& changed) {
  Json rows = Json::array(), claims = Json::array();
  for (const Compared& row : c.rows) {
    Json sides = Json::array();
    for (const auto& r : row.sides)
      sides.push_back(r ? to_json(*r) : Json(nullptr));
    Json out{{"experiment", row.id.experiment},
             {"method", row.id.method},
             {"stage", row.id.stage},
             {"n", row.id.n < 0 ? Json(nullptr) : Json(row.id.n)},
             {"seed", row.id.seed < 0 ? Json(nullptr) : Json(row.id.seed)},
             {"sides", std::move(sides)}};
    rows.push_back(std::move(out));
  }
  for (const ChangedClaim& claim : changed) {
    Json verdicts = Json::array();
    std::string id;
    for (const auto& side : claim.sides) {
      if (side) id = side->id;
      verdicts.push_back(side ? Json(word(*side)) : Json(nullptr));
    }
    claims.push_back({{"experiment", claim.experiment},
                      {"id", id},
                      {"verdicts", std::move(verdicts)}});
  }
  return {{"labels", c.labels},
          {"rows", std::move(rows)},
          {"changed_claims", std::move(claims)}};
}

}  // namespace physinv
