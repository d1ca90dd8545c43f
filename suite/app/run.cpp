#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "suite/app/options.h"
#include "suite/harness/campaign.h"
#include "suite/harness/context.h"
#include "suite/results/results.h"

namespace physinv {
namespace {

struct RunFlags {
  Selection selection;
  CampaignOptions campaign;
  std::string out;
  int jobs = 0;
  bool dry = false;

  std::vector<Flag> flags() {
    return selection.flags(
        {{"--jobs", "worker processes; default: cores / threads", &jobs},
         {"--threads",
          "threads inside a case (default 1); results do not change",
          &campaign.threads},
         {"--time-budget",
          "start no further case after so many seconds; the cases not "
          "run are named (exit 8), and the next run goes on with them",
          &campaign.time_budget,
          "SECONDS"},
         {"--out", "where to; default: results/<profile>", &out, "DIR"},
         {"--resume,!--fresh",
          "reuse finished stages (default), or run the selected cases again",
          &campaign.resume},
         {"--dry-run", "say what would run and what is reused", &dry},
         {"--trace",
          "record a hash of all iterates of the stages that run",
          &campaign.trace}});
  }

  void complete() {
    if (jobs == 0) jobs = std::max(1, available_cores() / campaign.threads);
    campaign.jobs = jobs;
    campaign.out = out.empty() ? "results/" + selection.profile : out;
  }

  nlohmann::json json() const {
    return {{"profile", selection.profile},
            {"filter", selection.filters},
            {"set", selection.sets},
            {"seeds", selection.seeds},
            {"shard", selection.shard},
            {"jobs", campaign.jobs},
            {"threads", campaign.threads},
            {"time_budget", campaign.time_budget},
            {"resume", campaign.resume},
            {"trace", campaign.trace},
            {"out", campaign.out.string()}};
  }
};

/// The records of these cases, out of all that the store holds.
std::vector<CaseRecord> own_records(std::vector<CaseRecord> cases,
                                    const std::vector<std::string>& names) {
  std::erase_if(cases, [&](const CaseRecord& c) {
    return std::find(names.begin(), names.end(), c.info.name) == names.end();
  });
  return cases;
}

void print_result(const RunFlags& flags, const CampaignResult& r) {
  fmt::print("{} stages run, {} reused{}; {}, bookkeeping {}{}\n",
             r.stages_run,
             r.stages_reused,
             r.origins.empty() ? "" : " (" + to_text(r.origins) + ")",
             duration_text(r.seconds),
             duration_text(r.bookkeeping),
             r.stage_cpu > 0 ? fmt::format(" ({:.2f} % of CPU)",
                                           100 * r.bookkeeping /
                                               (r.bookkeeping + r.stage_cpu))
                             : "");
  if (!r.not_run.empty()) {
    fmt::print("{}: {} cases not run:\n",
               r.interrupted ? "interrupted" : "out of time",
               r.not_run.size());
    for (const auto& name : r.not_run) fmt::print("  {}\n", name);
  }
  fmt::print("results: {}\n", flags.campaign.out.string());
}

}  // namespace

ExitCode run_verb(const Arguments& arguments) {
  RunFlags flags;
  if (!parse("physinv-bench run",
             "Runs the cases of a profile and writes their results. The "
             "default verb.\nExit codes and environment: physinv-bench --help",
             flags.flags(),
             arguments))
    return ExitCode::good;
  flags.complete();
  Prepared prepared = prepare(flags.selection.cases(&flags.campaign.campaign));
  if (flags.dry) {
    dry_run(prepared, flags.campaign, stdout);
    return ExitCode::good;
  }
  std::vector<std::string> names;
  for (const Case& c : prepared.cases) names.push_back(c.info.name);
  CampaignResult result = run_campaign(
      std::move(prepared), flags.campaign, flags.json(), Screen::of(stdout));
  fmt::print("{}", summary_table(own_records(std::move(result.cases), names)));
  print_result(flags, result);
  if (result.interrupted) return ExitCode::interrupted;
  if (!result.failed.empty()) {
    throw ExitError(
        ExitCode::case_failed,
        fmt::format("{} stages failed, first {}; the others are kept, and the "
                    "next run tries these again",
                    result.failed.size(),
                    result.failed.front()));
  }
  if (!result.not_run.empty())
    throw ExitError(ExitCode::incomplete,
                    fmt::format("incomplete: {} of {} cases not run, out of "
                                "time; the same command goes on with them",
                                result.not_run.size(),
                                names.size()));
  return ExitCode::good;
}

}  // namespace physinv
