#include "suite/cases/numerics/common/accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "suite/evidence/cell.h"
#include "suite/evidence/statistics.h"

namespace physinv {
namespace {

constexpr WorkOf kBoth[] = {WorkOf::forward, WorkOf::gradient};
constexpr WorkOf kAll[] = {WorkOf::forward, WorkOf::gradient, WorkOf::inverse};

/// What can be asked of all settings of a knob.
std::vector<WorkOf> asked(const Knob& knob) {
  std::vector<WorkOf> all(std::begin(kBoth), std::end(kBoth));
  if (std::all_of(
          knob.problems.begin(), knob.problems.end(), [](const auto& problem) {
            return contains(problem.provided, Needs::inverse);
          }))
    all.push_back(WorkOf::inverse);
  return all;
}

std::string stage_name(const Knob& knob, std::size_t place, WorkOf of) {
  std::string value = fmt::format("{:g}", knob.axis.values[place]);
  std::replace(value.begin(), value.end(), '.', '_');
  return fmt::format("{}-{}{}{}",
                     knob.id,
                     value,
                     of == WorkOf::forward ? "" : "-",
                     of == WorkOf::forward ? "" : to_string(of));
}

std::shared_ptr<const Stage> stage_of(const Knob& knob,
                                      std::size_t place,
                                      WorkOf of,
                                      const std::shared_ptr<Answers>& answers) {
  return work_precision(
      {.name = stage_name(knob, place, of),
       .problem = knob.problems[knob.problems.size() == 1 ? 0 : place],
       .base = knob.problems.front(),
       .reference = knob.reference,
       .exact = knob.exact,
       .of = of,
       .samples = knob.samples,
       .block = knob.blocks ? static_cast<Index>(knob.axis.values[place]) : 0,
       .repetitions = knob.repetitions,
       .answers = answers});
}

/// The median, in which what is not finite is large.
double typical_error(const Batch<double>& error) {
  std::vector<double> all(error.data(), error.data() + error.size());
  for (double& e : all)
    if (e < 0) e = HUGE_VAL;
  const double middle = median(std::move(all));
  return std::isfinite(middle) ? middle : -1;
}

const StageRecord* find_stage(const CaseRecord& chain,
                              const std::string& stage) {
  for (const StageRecord& s : chain.stages)
    if (s.stage == stage && s.arrays.contains("error")) return &s;
  return nullptr;
}

/// Power of the axis by which the errors fell from the value before: the
/// median of the samples', which need not be alike.
std::optional<double> order_of(const CaseRecord& chain,
                               const Knob& knob,
                               std::size_t place,
                               WorkOf of) {
  if (place == 0 || knob.blocks) return {};
  const auto* before = find_stage(chain, stage_name(knob, place - 1, of));
  const auto* after = find_stage(chain, stage_name(knob, place, of));
  if (before == nullptr || after == nullptr) return {};
  const auto& coarse = before->arrays.at("error");
  const auto& fine = after->arrays.at("error");
  std::vector<double> orders;
  for (Index i = 0; i < fine.size(); ++i)
    if (coarse(i) > 0 && fine(i) > 0)
      orders.push_back(
          std::log(coarse(i) / fine(i)) /
          std::log(knob.axis.values[place - 1] / knob.axis.values[place]));
  if (orders.empty()) return {};
  return median(std::move(orders));
}

/// In a run of all settings.
Quantity order_at(const Knob& knob, std::size_t place, WorkOf of) {
  return median({kAccuracy, stage_name(knob, place, of)},
                [=](const Run& run) -> std::optional<double> {
                  if (run.record->info.precision != Precision::f64) return {};
                  return order_of(*run.record, knob, place, of);
                });
}

const char* word(Precision precision) {
  return precision == Precision::f64 ? "double" : "float";
}

std::string setting_name(const Knob& knob,
                         std::size_t place,
                         Precision precision) {
  return fmt::format(
      "{} {:g}, {}", knob.axis.label, knob.axis.values[place], word(precision));
}

const Measurement* find(const std::vector<Measurement>& all,
                        const Knob& knob,
                        std::size_t place,
                        Precision precision,
                        WorkOf of) {
  for (const Measurement& m : all)
    if (m.knob == knob.id && m.place == place && m.precision == precision &&
        m.of == of)
      return &m;
  return nullptr;
}

/// Of which there are measurements.
std::vector<WorkOf> measured(const std::vector<Measurement>& all) {
  std::vector<WorkOf> some;
  for (const WorkOf of : kAll)
    if (of != WorkOf::inverse ||
        std::any_of(all.begin(), all.end(), [](const Measurement& m) {
          return m.of == WorkOf::inverse;
        }))
      some.push_back(of);
  return some;
}

Table settings_table(const std::vector<Measurement>& all,
                     const std::vector<Knob>& knobs) {
  Table table{
      .id = "work_precision",
      .title = "Settings, accuracy and time",
      .digits = 2,
      .corner = "setting",
      .columns = {},
      .note =
          "Relative errors, medians of the samples; us: per sample, "
          "fastest of the repetitions; order: the power of the knob by "
          "which errors fell from the value before, median of the "
          "samples. A setting is dominated by the fastest of its knob "
          "that is at least as accurate in less than nine tenths of "
          "its time.",
      .keys = {"knob", "value", "precision"},
      .across = Across{.key = "of",
                       .quantities = {"error", "order", "us", "dominated by"}}};
  const auto shown = measured(all);
  for (const WorkOf of : shown) {
    table.columns.push_back(fmt::format("{}: error", to_string(of)));
    table.columns.insert(table.columns.end(), {"order", "us", "dominated by"});
    table.across->values.emplace_back(to_string(of));
  }
  for (const Knob& knob : knobs) {
    for (const auto precision : {Precision::f64, Precision::f32}) {
      for (std::size_t k = 0; k < knob.axis.values.size(); ++k) {
        TableRow row;
        row.label = setting_name(knob, k, precision);
        row.keys = {knob.axis.label,
                    fmt::format("{}", knob.axis.values[k]),
                    word(precision)};
        for (const WorkOf of : shown) {
          const auto* m = find(all, knob, k, precision, of);
          if (m == nullptr) {
            row.cells.insert(row.cells.end(), 4, Cell{.text = kNotRun});
            continue;
          }
          const auto* better = dominated_by(all, *m);
          row.cells.push_back(m->error < 0 ? Cell{.text = kDiverged}
                                           : written(m->error, "{:.1e}"));
          row.cells.push_back(cell_of(m->order, kNothing));
          row.cells.push_back(cell_of(1e6 * m->seconds));
          row.cells.push_back(
              {.text = better == nullptr ? kNothing : better->setting});
        }
        table.rows.push_back(std::move(row));
      }
    }
  }
  return table;
}

Figure knob_figure(const std::vector<Measurement>& all, const Knob& knob) {
  Figure figure{.id = "work_precision_" + knob.id,
                .title = knob.title + ": accuracy over time",
                .note = fmt::format(
                    "{} from {:g} to {:g}. Errors are relative, medians of the "
                    "samples; seconds are per sample.{}",
                    knob.axis.label,
                    knob.axis.values.front(),
                    knob.axis.values.back(),
                    knob.order > 0 ? fmt::format(" In theory the error falls "
                                                 "with the power {:g}.",
                                                 knob.order)
                                   : "")};
  for (const WorkOf of : measured(all)) {
    Panel panel{.title = to_string(of),
                .x_label = "seconds per sample",
                .y_label = "relative error",
                .x_log = true,
                .y_log = true};
    for (const auto precision : {Precision::f64, Precision::f32}) {
      Series s{.label = word(precision),
               .method = precision == Precision::f64 ? "f64" : "f32",
               .markers = true};
      for (std::size_t k = 0; k < knob.axis.values.size(); ++k) {
        const auto* m = find(all, knob, k, precision, of);
        if (m == nullptr || m->error < 0 || m->seconds <= 0) continue;
        s.x.push_back(m->seconds);
        s.y.push_back(std::max(m->error, 1e-18));  // exact: on the scale
      }
      panel.series.push_back(std::move(s));
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

std::map<std::string, std::vector<Knob>>& declared() {
  static std::map<std::string, std::vector<Knob>> all;
  return all;
}

}  // namespace

const std::vector<Knob>& declare_knobs(const std::string& experiment,
                                       std::vector<Knob> knobs) {
  return declared()[experiment] = std::move(knobs);
}

const std::map<std::string, std::vector<Knob>>& all_knobs() {
  return declared();
}

Knob batch_knob(ProblemRecipe problem,
                Index samples,
                ProblemRecipe reference,
                ClosedForm exact) {
  SweepAxis axis{"samples per call", {}, true};
  for (Index block = 1; block <= samples; block *= 4)
    axis.values.push_back(static_cast<double>(block));
  return {.id = "batch",
          .title = "Samples per call",
          .axis = std::move(axis),
          .problems = {std::move(problem)},
          .reference = std::move(reference),
          .exact = std::move(exact),
          .samples = samples,
          .blocks = true};
}

Method accuracy_method(const std::vector<Knob>& knobs) {
  Method method{kAccuracy, {}};
  for (const Knob& knob : knobs) {
    const auto answers = no_answers_yet();
    for (const WorkOf of : asked(knob))
      for (std::size_t k = 0; k < knob.axis.values.size(); ++k)
        method.chain.push_back(stage_of(knob, k, of, answers));
  }
  return method;
}

std::vector<Row> accuracy_rows(Index n) {
  std::vector<Row> rows;
  for (const auto precision : {Precision::f64, Precision::f32})
    rows.push_back({.methods = {kAccuracy},
                    .n = {n},
                    .seeds = {0},
                    .precision = precision});
  return rows;
}

std::vector<Measurement> measurements(const Results& results,
                                      const std::string& experiment) {
  std::vector<Measurement> all;
  const auto& knobs = all_knobs().at(experiment);
  for (const CaseRecord& c : results.cases()) {
    if (c.info.experiment != experiment || c.info.method != kAccuracy) continue;
    const Precision precision = c.info.precision;
    for (const Knob& knob : knobs) {
      for (std::size_t k = 0; k < knob.axis.values.size(); ++k) {
        for (const WorkOf of : kAll) {
          const std::string stage = stage_name(knob, k, of);
          for (const StageRecord& s : c.stages) {
            if (s.stage != stage || !s.arrays.contains("error")) continue;
            const auto& error = s.arrays.at("error");
            all.push_back({.knob = knob.id,
                           .setting = setting_name(knob, k, precision),
                           .place = k,
                           .precision = precision,
                           .of = of,
                           .error = typical_error(error),
                           .order = order_of(c, knob, k, of),
                           .seconds = fastest_repetition(s.curve) /
                                      static_cast<double>(error.cols())});
          }
        }
      }
    }
  }
  return all;
}

const Measurement* fastest_within(const std::vector<Measurement>& all,
                                  WorkOf of,
                                  double error,
                                  const std::string& knob) {
  const Measurement* best = nullptr;
  for (const Measurement& m : all)
    if (m.of == of && m.error >= 0 && m.error <= error &&
        (knob.empty() || m.knob == knob) &&
        (best == nullptr || m.seconds < best->seconds))
      best = &m;
  return best;
}

const Measurement* dominated_by(const std::vector<Measurement>& all,
                                const Measurement& one) {
  const auto* best = fastest_within(
      all, one.of, one.error < 0 ? HUGE_VAL : one.error, one.knob);
  return best != nullptr && best->seconds < 0.9 * one.seconds ? best : nullptr;
}

void add_accuracy(Section& section,
                  const Results& results,
                  const std::string& experiment) {
  const auto found = all_knobs().find(experiment);
  if (found == all_knobs().end()) return;
  const auto& knobs = found->second;
  const auto all = measurements(results, experiment);
  section.tables.push_back(settings_table(all, knobs));
  for (const Knob& knob : knobs)
    section.figures.push_back(knob_figure(all, knob));
}

std::vector<Claim> order_claims(const std::vector<Knob>& knobs) {
  std::vector<Claim> claims;
  for (const Knob& knob : knobs) {
    if (knob.order == 0) continue;
    std::vector<Condition> conditions;
    for (const WorkOf of : kBoth) {
      std::vector<Quantity> orders;
      for (std::size_t k = knob.regime; k < knob.axis.values.size(); ++k)
        orders.push_back(order_at(knob, k, of));
      const std::string what = to_string(of);
      conditions.push_back(
          at_least(what + ", lowest order", least(orders), 0.85 * knob.order));
      conditions.push_back(
          at_most(what + ", highest order", most(orders), 1.15 * knob.order));
    }
    claims.push_back(
        {.id = fmt::format("O{}", claims.size() + 1),
         .from = "smoke",
         .says =
             fmt::format("{}: the error falls with the power {:g} from {:g} on",
                         knob.title,
                         knob.order,
                         knob.axis.values[knob.regime - 1]),
         .conditions = std::move(conditions)});
  }
  return claims;
}

}  // namespace physinv
