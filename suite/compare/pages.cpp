#include "suite/compare/pages.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "suite/compare/summary.h"
#include "suite/evidence/performance_profiles.h"
#include "suite/evidence/standings.h"
#include "suite/results/shortened.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

Cell number_cell(double value, const char* format) {
  return std::isfinite(value)
             ? Cell{.ours = value,
                    .text = fmt::format(fmt::runtime(format), value)}
             : Cell{.text = "not finite"};
}

/// Labels are folders as they were typed: no column is as wide as a path,
/// unless only that distinguishes two of them.
std::vector<std::string> heads_of(const std::vector<std::string>& labels) {
  std::vector<std::string> heads;
  for (const auto& label : labels) heads.push_back(shortened(label, 24));
  const std::set<std::string> different(heads.begin(), heads.end());
  const std::set<std::string> wanted(labels.begin(), labels.end());
  return different.size() == wanted.size() ? heads : labels;
}

/// As a factor, with every digit for programs.
std::string factor_text(double r) {
  return r == 1 ? "="
                : fmt::format(fmt::runtime(r >= 0.01 && r < 1000 ? "×{:.3g}"
                                                                 : "×{:.1e}"),
                              r);
}

/// The median of its pairs, and how far apart its quartiles are.
Cell factor_cell(const std::optional<Quartiles>& ratios,
                 const std::string& why) {
  if (!ratios) return {.text = why.empty() ? "–" : why};
  Cell cell{.text = std::isfinite(ratios->median) ? factor_text(ratios->median)
                                                  : "not finite"};
  if (std::isfinite(ratios->median)) cell.ours = ratios->median;
  return cell;
}

/// `unit` of the cell in units of the quartiles.
void set_spread(Cell& cell, const Quartiles& quartiles, double unit = 1) {
  const auto range = quartiles.range();
  if (cell.ours && range && std::isfinite(*range)) cell.spread = *range / unit;
}

/// The word alone if all agree.
std::string ends_text(const Reading& r) {
  if (r.ends.size() == 1) return std::string(to_string(r.ends.begin()->first));
  std::string out;
  for (const auto& [end, count] : r.ends)
    out +=
        fmt::format("{}{} {}", out.empty() ? "" : ", ", count, to_string(end));
  return out;
}

Cell bits_cell(const Reading& r) {
  return {.text = r.same_bits == r.stages
                      ? "same"
                      : fmt::format("{} of {}", r.same_bits, r.stages)};
}

Cell ends_cell(const Compared& row, std::size_t s, std::size_t worse) {
  const auto& a = row.sides.front();
  const auto& b = row.sides[s];
  if (!b) return {.text = "missing"};
  std::string text = !a || a->ends == b->ends
                         ? ends_text(*b)
                         : ends_text(*a) + " → " + ends_text(*b);
  if (worse > 0 && !row.members.empty())
    text += fmt::format(" ({} worse)", worse);
  return {.text = std::move(text)};
}

/// Does one median count as solved and the other not, in any pair? Such a ratio
/// says on which side of a gap the medians are, not how far losses moved.
bool crosses(const Compared& row, std::size_t s, double solved) {
  const auto stages = row.stages();
  return std::any_of(stages.begin(), stages.end(), [&](const Compared& stage) {
    const auto &a = stage.sides.front(), &b = stage.sides[s];
    return a && b && a->examples > 0 && b->examples > 0 &&
           (a->loss.median <= solved) != (b->loss.median <= solved);
  });
}

/// "solved 52 → 61 %", where both sides have examples.
std::string solved_text(const Reading& a, const Reading& b) {
  return fmt::format("solved {:.0f} → {:.0f} %",
                     percent_of(a.solved, a.examples),
                     percent_of(b.solved, b.examples));
}

/// What sets a stage of a group apart from the others, and how it fared.
std::string pair_text(const Compared& group,
                      const Compared& stage,
                      std::size_t s,
                      double solved) {
  std::string text;
  if (group.id.n < 0) text += fmt::format("n={}/", stage.id.n);
  text += fmt::format("seed={} ", stage.id.seed);
  const auto& a = stage.sides.front();
  const auto& b = stage.sides[s];
  if (!b) return text + "missing";
  if (a->ends != b->ends) return text + ends_text(*a) + " → " + ends_text(*b);
  if (crosses(stage, s, solved)) return text + solved_text(*a, *b);
  const double loss = loss_ratio(*a, *b);
  const double time = raised_ratio(time_ratio(*a, *b)).value_or(1);
  return text + (std::isinf(loss)         ? "not finite"
                 : loss == 1 && time != 1 ? "time " + factor_text(time)
                                          : factor_text(loss));
}

/// Seconds as they are compared.
const Quartiles& seconds_of(const Times& times) {
  return times.of_one_core() ? times.cpu : times.wall;
}

Cell time_cell(const Reading& r) {
  if (!r.times) return {.text = ends_text(r)};
  const Quartiles& seconds = seconds_of(*r.times);
  Cell cell = number_cell(1e3 * seconds.median, "{:.4g}");
  if (!r.times->of_one_core() && r.times->crowded) cell.text += " (crowded)";
  if (r.stages > 1 && seconds.count < r.stages)
    cell.text += fmt::format(" ({} of {})", seconds.count, r.stages);
  set_spread(cell, seconds, 1e-3);
  return cell;
}

Cell loss_cell(const Reading& r) {
  Cell cell = number_cell(r.loss.median, "{:.2e}");
  set_spread(cell, r.loss);
  return cell;
}

/// One cell per side.
template <class F>
void add_sides(TableRow& row, const Compared& c, F&& cell) {
  for (const auto& r : c.sides)
    row.cells.push_back(r ? cell(*r) : Cell{.text = "missing"});
}

/// Of a side against the first: ratios, end and bits; of a group how many
/// pairs it wins, and the worst.
void add_against(TableRow& out,
                 const Compared& row,
                 std::size_t s,
                 double solved) {
  const Against sum = against(row, s);
  const auto ratio = [&](const auto& ratios, const std::string& why = "") {
    out.cells.push_back(factor_cell(ratios, why));
    if (ratios) set_spread(out.cells.back(), *ratios);
  };
  ratio(sum.loss);
  if (crosses(row, s, solved))
    out.cells.back().text = solved_text(*row.sides.front(), *row.sides[s]);
  ratio(sum.raised_time, sum.no_time);
  if (row.members.empty() && sum.raised_time) {  // over repetitions
    const TimeRatio t = time_ratio(*row.sides.front(), *row.sides[s]);
    set_spread(out.cells.back(), t.b, std::max(t.a.median, kShortTime));
  }
  if (sum.raised_time && sum.timed < sum.pairs)
    out.cells.back().text += fmt::format(" ({} of {})", sum.timed, sum.pairs);
  ratio(sum.simulations);
  ratio(sum.passes);
  out.cells.push_back(ends_cell(row, s, sum.worse));
  out.cells.push_back(sum.pairs > 0 ? bits_cell(*row.sides[s])
                                    : Cell{.text = "–"});
  if (row.members.empty()) return;
  out.cells.push_back(
      {.text = fmt::format("{} of {}", sum.wins, sum.pairs) +
               (sum.ties > 0 ? fmt::format(", {} equal", sum.ties) : "")});
  out.cells.push_back(
      {.text = sum.worst ? pair_text(row, *sum.worst, s, solved) : "–"});
}

/// What a row is of, in columns of their own.
const std::vector<std::string> kKeys = {
    "experiment", "method", "n", "seed", "stage"};
std::vector<std::string> keys_of(const StageId& id) {
  const auto one = [](std::int64_t v) {
    return v < 0 ? std::string() : std::to_string(v);
  };
  return {id.experiment, id.method, one(id.n), one(id.seed), id.stage};
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
              .columns = heads_of(c.labels),
              .keys = kKeys,
              .across = Across{.key = "side"}};
  for (const Compared& row : c.rows) {
    table.rows.push_back({row.id.text(), {}, keys_of(row.id)});
    add_sides(table.rows.back(), row, cell);
  }
  return table;
}

Comparison of_experiment(const Comparison& all, const std::string& name) {
  Comparison own{all.labels, {}, all.thresholds};
  for (const auto& row : all.rows)
    if (row.id.experiment == name) own.rows.push_back(row);
  return own;
}

/// Loss over time of every method and side: a point per stage or group.
Figure loss_over_time(const Comparison& c) {
  Figure figure{.id = "work_precision",
                .title = "Loss over time of solving",
                .columns = 1};
  Panel panel{.x_label = "seconds",
              .y_label = "median loss",
              .x_log = true,
              .y_log = true};
  std::map<std::string, Series> series;
  std::size_t left_out = 0;
  for (const Compared& row : c.rows) {
    for (std::size_t s = 0; s < row.sides.size(); ++s) {
      if (!row.sides[s]) continue;
      const Reading& r = *row.sides[s];
      if (!r.times || !std::isfinite(r.loss.median)) {
        ++left_out;
        continue;
      }
      const std::string label = row.id.method + ", " + c.labels[s];
      Series& own = series[label];
      own.label = own.method = label;
      own.line = false, own.markers = true;
      own.x.push_back(seconds_of(*row.sides[s]->times).median);
      own.y.push_back(row.sides[s]->loss.median);
    }
  }
  for (auto& [label, own] : series) panel.series.push_back(std::move(own));
  figure.panels.push_back(std::move(panel));
  if (left_out > 0)
    figure.note = fmt::format(
        "Without {} points of stages that failed, diverged or have no finite "
        "median loss.",
        left_out);
  return figure;
}

Section overview(const Comparison& c,
                 const std::vector<ChangedClaim>& changed,
                 const std::vector<SideRank>& ranks) {
  Section section{.experiment = "compare",
                  .title = fmt::format("What changed from {}", c.labels[0])};
  const Comparison own = common(c);
  const auto methods = method_changes(own, ranks);
  section.standing =
      fmt::format("{}", fmt::join(summary_sentences(methods, own), ". "));
  for (Table& table :
       std::vector{method_table(methods, own, 40), folded_table(own, 40)})
    if (!table.rows.empty()) section.tables.push_back(std::move(table));
  if (!ranks.empty()) section.tables.push_back(rank_table(ranks, c.labels, 40));
  if (auto table = missing_table(c); !table.rows.empty())
    section.tables.push_back(std::move(table));
  if (const auto claims = judged_everywhere(changed); !claims.empty())
    section.tables.push_back(claims_table(claims, c.labels));
  return section;
}

std::string verdict_word(const ClaimResult& claim) {
  return std::string(words_of(claim.verdict));
}

}  // namespace

Table changes_table(const Comparison& c, std::size_t most) {
  Table table{.id = "changes",
              .title = "What changed most",
              .corner = "stage",
              .keys = kKeys};
  const bool groups = !c.rows.empty() && !c.rows.front().members.empty();
  std::vector<const char*> heads = {
      "loss", "time", "simulations", "passes", "end", "bits"};
  if (groups) heads.insert(heads.end(), {"wins", "worst pair"});
  const auto labels = heads_of(c.labels);
  for (const auto& label : labels) table.columns.push_back("loss " + label);
  for (std::size_t s = 1; s < labels.size(); ++s)
    for (const char* what : heads)
      table.columns.push_back(labels.size() == 2
                                  ? std::string(what)
                                  : fmt::format("{} {}", what, labels[s]));
  for (const Compared& row : c.rows) {
    if (table.rows.size() == most) break;
    TableRow out{row.id.text(), {}, keys_of(row.id)};
    add_sides(out, row, loss_cell);
    for (std::size_t s = 1; s < c.labels.size(); ++s)
      add_against(out, row, s, c.thresholds.solved);
    table.rows.push_back(std::move(out));
  }
  if (groups)
    table.note = "Medians over pairs of runs; wins are pairs with a lower loss";
  if (c.rows.size() > most)
    table.note += fmt::format("{}{} more lines changed less",
                              table.note.empty() ? "" : "; ",
                              c.rows.size() - most);
  return table;
}

std::string unchanged_text(const Comparison& c) {
  const auto unchanged =
      std::count_if(c.rows.begin(), c.rows.end(), [&](const Compared& row) {
        return row.unchanged(c.thresholds);
      });
  return fmt::format("{} of {} rows unchanged", unchanged, c.rows.size());
}

Table folded_table(const Comparison& c, std::size_t most) {
  Table table = changes_table(changed(c), most);
  table.note += (table.note.empty() ? "" : "; ") + unchanged_text(c);
  return table;
}

std::vector<Table> detail_tables(const Comparison& c) {
  std::vector<Table> tables;
  tables.push_back(per_side(c, "times", "Times of solving", "ms", time_cell));
  tables.push_back(
      per_side(c, "statuses", "How examples ended", "", [](const Reading& r) {
        return Cell{.text = status_text(r.statuses)};
      }));
  tables.push_back(
      per_side(c, "iterations", "Iterations", "", [](const Reading& r) {
        return number_cell(static_cast<double>(r.iterations), "{:.0f}");
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
          if (!r.counts.knows(counter)) return Cell{.text = "not counted"};
          return number_cell(static_cast<double>(r.counts[counter]), "{:.0f}");
        }));
  }
  return tables;
}

Table missing_table(const Comparison& c) {
  std::map<std::string, std::vector<std::size_t>> lacks;
  for (const Compared& row : c.rows) {
    for (const Compared& stage : row.stages()) {
      if (!stage.missing()) continue;
      auto& counts = lacks[stage.id.experiment];
      counts.resize(c.labels.size());
      for (std::size_t s = 0; s < stage.sides.size(); ++s)
        if (!stage.sides[s]) ++counts[s];
    }
  }
  Table table{.id = "missing",
              .title = "Stages that a side lacks",
              .digits = 0,
              .corner = "experiment",
              .columns = heads_of(c.labels)};
  for (const auto& [experiment, counts] : lacks) {
    table.rows.push_back({experiment, {}});
    for (const std::size_t count : counts)
      table.rows.back().cells.push_back({.ours = static_cast<double>(count)});
  }
  return table;
}

Table claims_table(const std::vector<ChangedClaim>& changed,
                   const std::vector<std::string>& labels) {
  Table table{.id = "claims",
              .title = "Claims whose verdict changed",
              .corner = "claim",
              .columns = heads_of(labels)};
  for (const ChangedClaim& c : changed) {
    TableRow row;
    for (const auto& side : c.sides)
      if (side && row.label.empty())
        row.label = fmt::format(
            "{} {}: {}", c.experiment, side->id, shortened(side->says, 60));
    for (std::size_t s = 0; s < c.sides.size(); ++s)
      row.cells.push_back(
          {.text = verdict_word(c.sides[s].value_or(ClaimResult{}))});
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<Section> compare_sections(const Comparison& c,
                                      const std::vector<Side>& sides,
                                      const std::vector<ChangedClaim>& changed,
                                      const std::vector<SideRank>& ranks) {
  std::vector<Section> sections = {overview(c, changed, ranks)};
  std::set<std::string> names;
  for (const auto& row : c.rows) names.insert(row.id.experiment);
  const Results all = pooled(sides);
  for (const auto& name : names) {
    const Comparison own = common(of_experiment(c, name));
    if (own.rows.empty()) continue;
    Section section{.experiment = name, .title = name};
    section.tables.push_back(changes_table(own, own.rows.size()));
    for (auto& table : detail_tables(own))
      section.tables.push_back(std::move(table));
    section.figures.push_back(loss_over_time(own));
    const CommonRuns runs = common_runs(all, name);
    add_standings(section, runs, {});
    for (auto& figure : performance_profile_figures(
             runs, {.title = name, .method_titles = {}}))
      section.figures.push_back(std::move(figure));
    sections.push_back(std::move(section));
  }
  return sections;
}

}  // namespace physinv
