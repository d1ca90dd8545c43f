#include "suite/gate/measure.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "suite/harness/campaign.h"
#include "suite/harness/errors.h"
#include "suite/harness/run_case.h"
#include "suite/results/results.h"

namespace physinv {
namespace {

std::vector<StageLine> run_traced(const std::vector<Case>& cases,
                                  const MeasureOptions& options,
                                  bool disturb,
                                  const Screen& screen) {
  if (cases.empty()) return {};
  const CampaignOptions campaign{.out = options.out,
                                 .jobs = options.jobs,
                                 .threads = 1,
                                 .resume = options.resume,
                                 .trace = true,
                                 .disturb = disturb,
                                 .campaign = {}};
  const auto result = run_campaign(prepare(cases, disturb),
                                   campaign,
                                   {{"trace", true}, {"disturb", disturb}},
                                   screen);
  if (result.interrupted)
    throw ExitError(ExitCode::interrupted,
                    fmt::format("interrupted; finished stages are in {}",
                                options.out.string()));
  const auto names = names_of(cases);
  auto records = load_results(options.out).cases();
  std::erase_if(records,
                [&](const auto& c) { return !names.contains(c.info.name); });
  return lines_of(records);
}

}  // namespace

std::set<std::string> names_of(const std::vector<Case>& cases) {
  std::set<std::string> names;
  for (const Case& c : cases) names.insert(c.info.name);
  return names;
}

std::vector<StageLine> lines_of(const std::vector<CaseRecord>& cases) {
  std::vector<StageLine> lines;
  for (const CaseRecord& c : cases)
    for (const StageRecord& s : c.stages) {
      lines.push_back(line_of(s));
      if (s.trajectory.empty() && has_result(s))
        throw UsageError(
            fmt::format("{} was run without a trace; run it with --trace "
                        "--fresh",
                        lines.back().name));
    }
  return lines;
}

std::vector<StageLine> measure(const std::vector<Case>& cases,
                               const MeasureOptions& options,
                               const Screen& screen) {
  return run_traced(cases, options, false, screen);
}

void measure_digits(std::vector<StageLine>& lines,
                    const std::vector<Case>& cases,
                    MeasureOptions options,
                    const Screen& screen) {
  options.out /= "disturbed";
  std::map<std::string, StageLine> repeats;
  for (auto& line : run_traced(cases, options, true, screen))
    repeats.emplace(line.name, line);
  std::map<std::string, Precision> precisions;
  for (const Case& c : cases) precisions[c.info.name] = working_precision(c);
  for (StageLine& line : lines) {
    const auto at = repeats.find(line.name);
    if (at != repeats.end())
      enter_disturbed(line, at->second, precisions[case_of(line.name)]);
  }
}

}  // namespace physinv
