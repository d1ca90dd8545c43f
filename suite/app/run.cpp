#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "suite/app/export.h"
#include "suite/app/habits.h"
#include "suite/app/speeds.h"
#include "suite/core/clock.h"
#include "suite/core/hash.h"
#include "suite/harness/campaign.h"
#include "suite/harness/context.h"
#include "suite/harness/output.h"
#include "suite/harness/stop_signal.h"
#include "suite/planning/budget.h"
#include "suite/planning/predict.h"
#include "suite/results/crowded.h"
#include "suite/results/file.h"
#include "suite/results/repetitions.h"
#include "suite/results/results.h"
#include "suite/results/store.h"

namespace physinv {
namespace {

/// Shorter budgets are not spent on measuring speeds.
constexpr double kBudgetForTrials = 60;

struct RunFlags {
  Selection selection;
  Habits habits;
  CampaignOptions campaign;
  std::string out, budget, checkpoint;
  int jobs = 0;
  bool dry = false;

  std::vector<Flag> flags() {
    std::vector<Flag> own = {
        {"--jobs", "worker processes; default: cores / threads", &jobs},
        {"--threads",
         "threads inside a case (default 1); results do not change",
         &campaign.threads},
        {"--time-budget",
         "start no case that would end later, such as 10m: first every method "
         "on one seed, then more seeds where the ranking is undecided; what "
         "is left out is named (exit 10), and the next run goes on with it",
         &budget,
         "TIME"},
        {"--out", "where to; default: results/<profile>", &out, "DIR"},
        {"--resume,!--fresh",
         "reuse finished stages (default), or run the selected cases again",
         &campaign.resume},
        {"--checkpoint",
         "how often a stage under way lays its state down, to go on from there "
         "should it be killed (default 60 s)",
         &checkpoint,
         "TIME"},
        {"--break-lock",
         "where the file system has no locks: take over from a process of "
         "another machine that has ended; its name is shown",
         &campaign.break_lock},
        {"--dry-run", "say what would run and what is reused", &dry},
        {"--trace",
         "record a hash of all iterates of the stages that run",
         &campaign.trace}};
    const auto more = habits.flags();
    own.insert(own.end(), more.begin(), more.end());
    return selection.flags(own);
  }

  void complete() {
    if (jobs == 0) jobs = std::max(1, available_cores() / campaign.threads);
    campaign.jobs = jobs;
    habits.complete(selection);
    if (!budget.empty())
      campaign.time_budget = parse_duration("--time-budget", budget);
    if (!checkpoint.empty())
      campaign.checkpoint_seconds = parse_duration("--checkpoint", checkpoint);
    campaign.out = out.empty() ? "results/" + selection.profile : out;
  }

  nlohmann::json json() const {
    return {{"profile", selection.profile},
            {"filter", selection.filters},
            {"set", selection.sets},
            {"seeds", selection.seeds},
            {"shard", selection.shard},
            {"cases", one_line(selection.list)},
            {"jobs", campaign.jobs},
            {"threads", campaign.threads},
            {"time_budget", campaign.time_budget},
            {"resume", campaign.resume},
            {"trace", campaign.trace},
            {"out", one_line(campaign.out.string())}};
  }
};

/// Losses bit by bit.
std::string loss_bits(const StageRecord& s) {
  return hex64(
      hash_bytes(s.loss.data(),
                 static_cast<std::size_t>(s.loss.size()) * sizeof(double),
                 0));
}

/// The records of these cases, out of all that the store holds.
std::vector<CaseRecord> own_records(std::vector<CaseRecord> cases,
                                    const std::vector<std::string>& names) {
  std::erase_if(cases, [&](const CaseRecord& c) {
    return std::find(names.begin(), names.end(), c.info.name) == names.end();
  });
  return cases;
}

/// What the cases will take, by short runs where the budget has room for them;
/// else only in proportion, by their counted operations.
std::vector<double> seconds_of(const std::vector<Case>& cases, double budget) {
  std::vector<double> seconds;
  if (budget < kBudgetForTrials) {
    for (const Case& c : cases) seconds.push_back(c.operations());
    return seconds;
  }
  Trials trials = known_speeds();
  for (const Cost& cost : predict(cases, trials))
    seconds.push_back(cost.seconds);
  trials.save();
  return seconds;
}

/// A coarse pass first; the budget counts from here on.
void follow_budget(CampaignOptions& campaign, const std::vector<Case>& cases) {
  const double begin = now().wall;
  auto seconds = seconds_of(cases, campaign.time_budget);
  if (campaign.time_budget >= kBudgetForTrials) {
    campaign.expected_seconds = seconds;
    campaign.time_budget =
        std::max(1e-6, campaign.time_budget - (now().wall - begin));
  }
  campaign.order = [cases, seconds = std::move(seconds)](
                       std::vector<std::size_t> queue,
                       const Finished& finished) {
    return budget_order(cases, std::move(queue), finished, seconds);
  };
}

/// Cases per experiment and n, where the budget left some out.
std::string left_out_text(const std::vector<std::string>& names) {
  std::map<std::string, std::vector<std::string>> seeds;
  for (const auto& name : names) {
    const auto at = name.rfind("/seed=");
    seeds[name.substr(0, at)].push_back(name.substr(at + 6));
  }
  std::string text;
  for (const auto& [chain, left] : seeds)
    text += fmt::format("  {} seeds {}\n", chain, fmt::join(left, ", "));
  return text;
}

std::string result_text(const RunFlags& flags, const CampaignResult& r) {
  const auto share = [&](double of) {
    return r.stage_cpu > 0 ? fmt::format(" ({:.2f} % of CPU)", 100 * of / r.cpu)
                           : "";
  };
  std::string text = fmt::format(
      "{} stages run, {} reused{}; {}, data {}{}, evaluation {}{}, "
      "bookkeeping {}{}, waiting for the disk {}\n",
      r.stages_run,
      r.stages_reused,
      r.origins.empty() ? "" : " (" + to_text(r.origins) + ")",
      duration_text(r.seconds),
      duration_text(r.data_cpu),
      share(r.data_cpu),
      duration_text(r.evaluation),
      share(r.evaluation),
      duration_text(r.bookkeeping),
      share(r.bookkeeping),
      duration_text(r.waiting));
  if (!r.not_run.empty())
    text += fmt::format("{}: {} cases not run:\n{}",
                        r.interrupted ? "interrupted" : "out of time",
                        r.not_run.size(),
                        left_out_text(r.not_run));
  return text + fmt::format("results: {}\n", flags.campaign.out.string());
}

/// What a campaign that did not come to its end says last.
std::string go_on_text(const RunFlags& flags) {
  return flags.campaign.resume
             ? "the same command goes on with them"
             : "the same command without --fresh goes on with them";
}

/// Runs the cases again beside the store, only for their times.
Repetitions repeat(const Prepared& prepared,
                   const RunFlags& flags,
                   const std::vector<CaseRecord>& cases,
                   const Screen& screen) {
  std::map<std::string, std::string> hashes;
  for (const CaseRecord& c : cases)
    for (const StageRecord& s : c.stages)
      hashes[c.info.name + "/" + s.stage] = loss_bits(s);
  Repetitions all;
  CampaignOptions again = flags.campaign;
  again.resume = false;
  for (int k = 1; k < flags.habits.repetitions; ++k) {
    const PassingStore passing(flags.campaign.out);
    again.out = passing.path();
    const auto r = run_campaign(prepared, again, flags.json(), screen);
    for (const CaseRecord& c : r.cases) {
      for (const StageRecord& s : c.stages) {
        const std::string name = c.info.name + "/" + s.stage;
        if (!has_result(s) || !hashes.contains(name)) continue;
        if (loss_bits(s) != hashes[name])
          throw std::logic_error(name + " has other results when repeated");
        all[name + " " + s.key].push_back(s.clocks.solve);
      }
    }
    if (r.interrupted) break;
  }
  return all;
}

/// In the formats of Google Benchmark's flags.
void write_exports(const RunFlags& flags, bool to_screen) {
  const Habits& habits = flags.habits;
  if (!to_screen && habits.out.empty()) return;
  const Loaded loaded = load(flags.campaign.out.string(), stderr);
  if (to_screen) put(stdout, exported(loaded, habits.format));
  if (!habits.out.empty())
    write_atomically(habits.out, exported(loaded, habits.out_format));
}

}  // namespace

ExitCode run_verb(const Arguments& arguments) {
  RunFlags flags;
  if (!parse("run",
             "Runs the cases of a profile and writes their results. The "
             "default verb.\nExit codes and environment: --help without verb.",
             flags.flags(),
             arguments))
    return ExitCode::good;
  flags.complete();
  if (flags.habits.list) {
    for (const Case& c : flags.selection.cases())
      fmt::print("{}\n", c.info.name);
    return ExitCode::good;
  }
  auto cases = flags.selection.cases(&flags.campaign.campaign);
  Prepared prepared = prepare(std::move(cases));
  if (flags.dry) {
    dry_run(prepared, flags.campaign, stdout);
    return ExitCode::good;
  }
  if (flags.campaign.time_budget > 0)
    follow_budget(flags.campaign, prepared.cases);
  std::vector<std::string> names;
  for (const Case& c : prepared.cases) names.push_back(c.info.name);
  std::FILE* stream = flags.habits.format == "console" ? stdout : stderr;
  const Screen screen = Screen::of(stream);
  const bool repeats = flags.habits.repetitions > 1;
  CampaignResult result = run_campaign(repeats ? prepared : std::move(prepared),
                                       flags.campaign,
                                       flags.json(),
                                       screen);
  if (repeats && !result.interrupted)
    keep_repetitions(flags.campaign.out,
                     repeat(prepared, flags, result.cases, screen),
                     {.break_lock = flags.campaign.break_lock});
  result.interrupted = result.interrupted || stop_signals() > 0;
  const auto own = own_records(std::move(result.cases), names);
  put(stream, summary_table(own));
  if (const auto text = crowded_text(own); !text.empty())
    put(stream, text + '\n');
  put(stream, result_text(flags, result));
  write_exports(flags, stream != stdout);
  if (result.interrupted)
    throw ExitError(ExitCode::interrupted,
                    fmt::format("interrupted: {} of {} cases not run; what had "
                                "finished is kept, {}",
                                result.not_run.size(),
                                names.size(),
                                go_on_text(flags)));
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
                                "time; {}",
                                result.not_run.size(),
                                names.size(),
                                go_on_text(flags)));
  return ExitCode::good;
}

}  // namespace physinv
