#include "suite/evidence/failures.h"

#include <fmt/format.h>

#include <algorithm>

#include "suite/results/crowded.h"
#include "suite/results/results.h"
#include "suite/results/shortened.h"

namespace physinv {
namespace {

constexpr std::string_view kFailed = " failed";
constexpr std::size_t kMessage = 120;

bool has_failed(const CaseRecord& c, const std::string& stage) {
  return std::any_of(
      c.stages.begin(), c.stages.end(), [&](const StageRecord& s) {
        return (stage.empty() || s.stage == stage) && !has_result(s);
      });
}

}  // namespace

std::string failed_text(const Evidence& evidence, const Select& select) {
  const std::string& experiment =
      select.experiment.empty() ? evidence.experiment : select.experiment;
  Index failed = 0, runs = 0;
  for (const CaseRecord& c : evidence.results.cases()) {
    if (c.info.method != select.method || c.info.experiment != experiment ||
        c.info.n < select.first || c.info.n > select.last)
      continue;
    ++runs;
    failed += has_failed(c, select.stage);
  }
  return failed == 0 ? ""
                     : fmt::format("{} of {} runs{}", failed, runs, kFailed);
}

std::string why_no_value(const Evidence& evidence, const Select& select) {
  const auto found = find_runs(evidence, select);
  if (found.empty()) return select.text() + " not run";
  const bool crowded =
      std::all_of(found.begin(), found.end(), [](const Run& run) {
        return is_crowded(*run.stage);
      });
  return select.text() +
         (crowded ? " crowded" : " too short, or without this value");
}

std::string failed_part(const std::string& missing) {
  const auto at = missing.rfind(": ");
  return at != std::string::npos && missing.ends_with(kFailed)
             ? missing.substr(at + 2)
             : "";
}

Table failed_runs(const Results& results, const std::string& experiment) {
  Table table{.id = "failed_runs",
              .title = "Runs that failed",
              .digits = 0,
              .corner = "run",
              .columns = {"stage", "why"},
              .keys = {"method", "n", "seed"}};
  std::size_t runs = 0;
  for (const CaseRecord& c : results.cases()) {
    if (c.info.experiment != experiment) continue;
    ++runs;
    const auto first = std::find_if(
        c.stages.begin(), c.stages.end(), [](const StageRecord& s) {
          return !has_result(s);
        });
    if (first == c.stages.end()) continue;
    const std::string n = std::to_string(c.info.n),
                      seed = std::to_string(c.info.seed);
    table.rows.push_back(
        {fmt::format("{}, n = {}, seed {}", c.info.method, n, seed),
         {{.text = first->stage},
          {.text = shortened(first->message, kMessage)}},
         {c.info.method, n, seed}});
  }
  table.note = fmt::format(
      "{} of {} runs failed. Claims and cells that depend on them have no "
      "value. Comparisons of methods count them as unsolved, with the time and "
      "the simulations that they spent and the highest final loss. Figures "
      "show the other runs.",
      table.rows.size(),
      runs);
  return table;
}

}  // namespace physinv
