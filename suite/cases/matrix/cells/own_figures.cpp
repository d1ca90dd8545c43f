#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "suite/cases/matrix/cells/own.h"
#include "suite/core/median.h"
#include "suite/evidence/cell.h"
#include "suite/harness/registry.h"
#include "suite/results/solved_loss.h"

namespace physinv::matrix {
namespace {

/// Numbers of the problems of all seeds.
struct Numbers {
  std::vector<double> loss, iterations, seconds;
};

/// Of all stages of the chain, if it is known of each.
std::optional<double> seconds_of(const Run& run, TimedStages& timed) {
  double sum = 0;
  for (const StageRecord& stage : run.record->stages) {
    const auto seconds = timed.seconds(stage);
    if (!seconds) return {};
    sum += *seconds;
  }
  return sum;
}

Numbers numbers_of(const std::vector<Run>& runs, TimedStages& timed) {
  Numbers all;
  for (const Run& run : runs) {
    const StageRecord& s = *run.stage;
    all.loss.insert(all.loss.end(), s.loss.begin(), s.loss.end());
    all.iterations.insert(all.iterations.end(),
                          s.example_iterations.begin(),
                          s.example_iterations.end());
    if (const auto seconds = seconds_of(run, timed))
      all.seconds.push_back(*seconds);
  }
  for (double& v : all.loss)
    if (!std::isfinite(v)) v = std::numeric_limits<double>::infinity();
  return all;
}

std::optional<double> middle(const std::vector<double>& values) {
  if (values.empty()) return {};
  return median(values);
}

std::optional<double> solved(const std::vector<double>& losses) {
  if (losses.empty()) return {};
  const auto below = std::count_if(losses.begin(), losses.end(), [](double v) {
    return v <= kSolvedByDefault;
  });
  return 100 * static_cast<double>(below) / static_cast<double>(losses.size());
}

}  // namespace

Section own_report(const MatrixProblem& problem, const Evidence& evidence) {
  Table table{
      .id = "methods",
      .title = "Methods on " + problem.title,
      .corner = "n, method",
      .columns = {"solved, %", "median loss", "median iterations", "seconds"},
      .keys = {"n", "method"}};
  TimedStages timed;
  const auto experiment = registry().find(evidence.experiment);
  const auto add = [&](const std::string& n,
                       const std::string& id,
                       std::vector<Cell> cells) {
    table.rows.push_back({.label = fmt::format("{}, {}", n, id),
                          .cells = std::move(cells),
                          .keys = {n, id}});
  };
  for (const Index n : evidence.results.sizes(evidence.experiment)) {
    for (const Method& m : experiment->methods) {
      const auto runs = find_runs(evidence, Select{m.id}.of_sizes(n, n));
      if (runs.empty()) continue;
      const Numbers of = numbers_of(runs, timed);
      add(fmt::format("{}", n),
          m.id,
          {written(solved(of.loss), "{:.0f}"),
           written(middle(of.loss)),
           written(middle(of.iterations)),
           written(middle(of.seconds))});
    }
  }
  for (const auto& [id, why] : skipped_methods(problem))
    add(kNothing,
        id,
        {{.text = "skipped: " + why},
         {.text = kNothing},
         {.text = kNothing},
         {.text = kNothing}});
  table.note = fmt::format(
      "Losses and iterations are those of a method's last stage, seconds of "
      "all its stages. solved: share of the problems of all seeds whose final "
      "loss is at most {:g}. {}",
      kSolvedByDefault,
      timed.note());
  return {.tables = {std::move(table)}};
}

}  // namespace physinv::matrix
