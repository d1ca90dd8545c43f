#include "suite/cases/numerics/common/accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "suite/core/math.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/statistics.h"

namespace physinv {
namespace {

constexpr WorkOf kBoth[] = {WorkOf::forward, WorkOf::gradient};
constexpr WorkOf kAll[] = {WorkOf::forward, WorkOf::gradient, WorkOf::inverse};

/// What can be asked of all settings of a parameter.
std::vector<WorkOf> asked(const NumericalParameter& parameter) {
  std::vector<WorkOf> all(std::begin(kBoth), std::end(kBoth));
  if (std::all_of(parameter.problems.begin(),
                  parameter.problems.end(),
                  [](const auto& problem) {
                    return contains(problem.provided, Needs::inverse);
                  }))
    all.push_back(WorkOf::inverse);
  return all;
}

std::string stage_name(const NumericalParameter& parameter,
                       std::size_t place,
                       WorkOf of) {
  std::string value = fmt::format("{:g}", parameter.axis.values[place]);
  std::replace(value.begin(), value.end(), '.', '_');
  return fmt::format("{}-{}{}{}",
                     parameter.id,
                     value,
                     of == WorkOf::forward ? "" : "-",
                     of == WorkOf::forward ? "" : to_string(of));
}

std::shared_ptr<const Stage> stage_of(const NumericalParameter& parameter,
                                      std::size_t place,
                                      WorkOf of,
                                      const std::shared_ptr<Answers>& answers) {
  return work_precision(
      {.name = stage_name(parameter, place, of),
       .problem =
           parameter.problems[parameter.problems.size() == 1 ? 0 : place],
       .base = parameter.problems.front(),
       .reference = parameter.reference,
       .exact = parameter.exact,
       .of = of,
       .samples = parameter.samples,
       .block = parameter.blocks
                    ? static_cast<Index>(parameter.axis.values[place])
                    : 0,
       .repetitions = parameter.repetitions,
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
                               const NumericalParameter& parameter,
                               std::size_t place,
                               WorkOf of) {
  if (place == 0 || parameter.blocks) return {};
  const auto* before = find_stage(chain, stage_name(parameter, place - 1, of));
  const auto* after = find_stage(chain, stage_name(parameter, place, of));
  if (before == nullptr || after == nullptr) return {};
  const auto& coarse = before->arrays.at("error");
  const auto& fine = after->arrays.at("error");
  std::vector<double> orders;
  for (Index i = 0; i < fine.size(); ++i)
    if (coarse(i) > 0 && fine(i) > 0)
      orders.push_back(math::log(coarse(i) / fine(i)) /
                       math::log(parameter.axis.values[place - 1] /
                                 parameter.axis.values[place]));
  if (orders.empty()) return {};
  return median(std::move(orders));
}

/// In a run of all settings.
Quantity order_at(const NumericalParameter& parameter,
                  std::size_t place,
                  WorkOf of) {
  return median({kAccuracy, stage_name(parameter, place, of)},
                [=](const Run& run) -> std::optional<double> {
                  if (run.record->info.precision != Precision::f64) return {};
                  return order_of(*run.record, parameter, place, of);
                });
}

const char* word(Precision precision) {
  return precision == Precision::f64 ? "double" : "float";
}

std::string setting_name(const NumericalParameter& parameter,
                         std::size_t place,
                         Precision precision) {
  return fmt::format("{} {:g}, {}",
                     parameter.axis.label,
                     parameter.axis.values[place],
                     word(precision));
}

const Measurement* find(const std::vector<Measurement>& all,
                        const NumericalParameter& parameter,
                        std::size_t place,
                        Precision precision,
                        WorkOf of) {
  for (const Measurement& m : all)
    if (m.parameter == parameter.id && m.place == place &&
        m.precision == precision && m.of == of)
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
                     const std::vector<NumericalParameter>& parameters) {
  Table table{
      .id = "work_precision",
      .title = "Settings, accuracy and time",
      .digits = 2,
      .corner = "setting",
      .columns = {},
      .note =
          "Relative errors, medians of the samples; us: per sample, "
          "fastest of the repetitions; order: the power of the parameter by "
          "which errors fell from the value before, median of the "
          "samples. A setting is dominated by the fastest of its parameter "
          "that is at least as accurate in less than nine tenths of "
          "its time.",
      .keys = {"parameter", "value", "precision"},
      .across = Across{.key = "of",
                       .quantities = {"error", "order", "us", "dominated by"}}};
  const auto shown = measured(all);
  for (const WorkOf of : shown) {
    table.columns.push_back(fmt::format("{}: error", to_string(of)));
    table.columns.insert(table.columns.end(), {"order", "us", "dominated by"});
    table.across->values.emplace_back(to_string(of));
  }
  for (const NumericalParameter& parameter : parameters) {
    for (const auto precision : {Precision::f64, Precision::f32}) {
      for (std::size_t k = 0; k < parameter.axis.values.size(); ++k) {
        TableRow row;
        row.label = setting_name(parameter, k, precision);
        row.keys = {parameter.axis.label,
                    fmt::format("{}", parameter.axis.values[k]),
                    word(precision)};
        for (const WorkOf of : shown) {
          const auto* m = find(all, parameter, k, precision, of);
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

Figure parameter_figure(const std::vector<Measurement>& all,
                        const NumericalParameter& parameter) {
  Figure figure{
      .id = "work_precision_" + parameter.id,
      .title = parameter.title + ": accuracy over time",
      .note = fmt::format(
          "{} from {:g} to {:g}. Errors are relative, medians of the "
          "samples; seconds are per sample.{}",
          parameter.axis.label,
          parameter.axis.values.front(),
          parameter.axis.values.back(),
          parameter.order > 0 ? fmt::format(" In theory the error falls "
                                            "with the power {:g}.",
                                            parameter.order)
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
      for (std::size_t k = 0; k < parameter.axis.values.size(); ++k) {
        const auto* m = find(all, parameter, k, precision, of);
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

std::map<std::string, std::vector<NumericalParameter>>& declared() {
  static std::map<std::string, std::vector<NumericalParameter>> all;
  return all;
}

}  // namespace

const std::vector<NumericalParameter>& declare_parameters(
    const std::string& experiment, std::vector<NumericalParameter> parameters) {
  return declared()[experiment] = std::move(parameters);
}

const std::map<std::string, std::vector<NumericalParameter>>& all_parameters() {
  return declared();
}

NumericalParameter batch_parameter(ProblemRecipe problem,
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

Method accuracy_method(const std::vector<NumericalParameter>& parameters) {
  Method method{kAccuracy, {}};
  for (const NumericalParameter& parameter : parameters) {
    const auto answers = no_answers_yet();
    for (const WorkOf of : asked(parameter))
      for (std::size_t k = 0; k < parameter.axis.values.size(); ++k)
        method.chain.push_back(stage_of(parameter, k, of, answers));
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

std::vector<Measurement> measurements(const Evidence& e) {
  std::vector<Measurement> all;
  const auto& parameters = all_parameters().at(e.experiment);
  for (const CaseRecord& c : e.results.cases()) {
    if (c.info.experiment != e.experiment || c.info.method != kAccuracy)
      continue;
    const Precision precision = c.info.precision;
    for (const NumericalParameter& parameter : parameters) {
      for (std::size_t k = 0; k < parameter.axis.values.size(); ++k) {
        for (const WorkOf of : kAll) {
          const std::string stage = stage_name(parameter, k, of);
          for (const StageRecord& s : c.stages) {
            if (s.stage != stage || !s.arrays.contains("error")) continue;
            const auto& error = s.arrays.at("error");
            all.push_back({.parameter = parameter.id,
                           .setting = setting_name(parameter, k, precision),
                           .place = k,
                           .precision = precision,
                           .of = of,
                           .error = typical_error(error),
                           .order = order_of(c, parameter, k, of),
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
                                  const std::string& parameter) {
  const Measurement* best = nullptr;
  for (const Measurement& m : all)
    if (m.of == of && m.error >= 0 && m.error <= error &&
        (parameter.empty() || m.parameter == parameter) &&
        (best == nullptr || m.seconds < best->seconds))
      best = &m;
  return best;
}

const Measurement* dominated_by(const std::vector<Measurement>& all,
                                const Measurement& one) {
  const auto* best = fastest_within(
      all, one.of, one.error < 0 ? HUGE_VAL : one.error, one.parameter);
  return best != nullptr && best->seconds < 0.9 * one.seconds ? best : nullptr;
}

void add_accuracy(Section& section, const Evidence& e) {
  const auto found = all_parameters().find(e.experiment);
  if (found == all_parameters().end()) return;
  const auto& parameters = found->second;
  const auto all = measurements(e);
  section.tables.push_back(settings_table(all, parameters));
  for (const NumericalParameter& parameter : parameters)
    section.figures.push_back(parameter_figure(all, parameter));
}

std::vector<Claim> order_claims(
    const std::vector<NumericalParameter>& parameters) {
  std::vector<Claim> claims;
  for (const NumericalParameter& parameter : parameters) {
    if (parameter.order == 0) continue;
    std::vector<Condition> conditions;
    for (const WorkOf of : kBoth) {
      std::vector<Quantity> orders;
      for (std::size_t k = parameter.regime; k < parameter.axis.values.size();
           ++k)
        orders.push_back(order_at(parameter, k, of));
      const std::string what = to_string(of);
      conditions.push_back(at_least(
          what + ", lowest order", least(orders), 0.85 * parameter.order));
      conditions.push_back(at_most(
          what + ", highest order", most(orders), 1.15 * parameter.order));
    }
    claims.push_back(
        {.id = fmt::format("O{}", claims.size() + 1),
         .from = "smoke",
         .says =
             fmt::format("{}: the error falls with the power {:g} from {:g} on",
                         parameter.title,
                         parameter.order,
                         parameter.axis.values[parameter.regime - 1]),
         .conditions = std::move(conditions)});
  }
  return claims;
}

}  // namespace physinv
