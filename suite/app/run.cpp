#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "suite/app/benchmark_flags.h"
#include "suite/app/conclude.h"
#include "suite/app/export.h"
#include "suite/app/installed.h"
#include "suite/app/run_budget.h"
#include "suite/app/speeds.h"
#include "suite/core/clock.h"
#include "suite/core/hash.h"
#include "suite/harness/campaign.h"
#include "suite/harness/context.h"
#include "suite/harness/output.h"
#include "suite/harness/progress.h"
#include "suite/harness/stop_signal.h"
#include "suite/planning/forecast.h"
#include "suite/results/crowded.h"
#include "suite/results/results.h"
#include "suite/store/catalog.h"
#include "suite/store/file.h"
#include "suite/store/plain_text.h"
#include "suite/store/repetitions.h"
#include "suite/store/store.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

/// UTF-8, with a sign in the place of what is none.
std::string valid_text(const std::string& text) {
  constexpr auto kReplace = nlohmann::json::error_handler_t::replace;
  return nlohmann::json::parse(
      nlohmann::json(text).dump(-1, ' ', false, kReplace));
}

struct RunFlags {
  Selection selection;
  BenchmarkFlags benchmark;
  CampaignOptions campaign;
  std::string out, budget, checkpoint, config;
  int jobs = 0;
  bool dry = false, quiet = false, report = true;

  std::vector<Flag> flags() {
    std::vector<Flag> own = {
        selection.arguments(),
        {"-j,--jobs", "worker processes; default: cores / threads", &jobs},
        {"--threads",
         "threads inside a case (default 1); results do not change",
         &campaign.threads},
        {"--share-cores",
         "once no case waits, give free cores to running cases: a stage that "
         "saves checkpoints continues in more threads; results do not change",
         &campaign.share_cores},
        {"--time-budget",
         "wall time of the run, such as 10m: all methods on one seed first, "
         "then more seeds where the ranking is undecided; cases that would "
         "end later are listed (exit 10), and the next run continues there",
         &budget,
         "TIME"},
        {"--out", "output directory; default: results/<profile>", &out, "DIR"},
        {"--resume,!--fresh",
         "reuse finished stages (default), or run the selected cases again",
         &campaign.resume},
        {"--checkpoint",
         "how often a running stage saves a checkpoint, from which it resumes "
         "if it is killed (default 60 s)",
         &checkpoint,
         "TIME"},
        {"--break-lock",
         "on file systems without locks: remove the lock of a process on "
         "another machine that has ended; its name is printed",
         &campaign.break_lock},
        {"--config",
         "read flags from this TOML or JSON file; flags on the command line "
         "override it; its text is recorded with the results",
         &config},
        {"--dry-run", "print what would run and what is reused", &dry},
        {"-q,--quiet", "print nothing until the end", &quiet},
        {"--report,!--no-report",
         "write the report and print measured and published values (default; "
         "off for a shard and --cases)",
         &report},
        {"--trace",
         "record a hash of all iterates of the stages that run",
         &campaign.trace}};
    const auto more = benchmark.flags();
    own.insert(own.end(), more.begin(), more.end());
    return selection.flags(own);
  }

  void complete() {
    if (jobs == 0) jobs = std::max(1, available_cores() / campaign.threads);
    campaign.jobs = jobs;
    benchmark.complete(selection);
    if (campaign.share_cores && benchmark.repetitions > 1)
      throw UsageError(
          "--benchmark_repetitions times stages whose threads --share-cores "
          "changes; use one of the two");
    if (!budget.empty())
      campaign.time_budget = parse_duration("--time-budget", budget);
    if (!checkpoint.empty())
      campaign.checkpoint_seconds = parse_duration("--checkpoint", checkpoint);
    campaign.out = out.empty() ? "results/" + selection.profile : out;
    report = report && program().conclude != nullptr &&
             selection.shard.empty() && selection.list.empty() &&
             variable("PHYSINV_NO_REPORT").empty();
  }

  nlohmann::json json() const {
    const std::string text = config.empty() ? "" : read_plain_text(config);
    return {{"profile", selection.profile},
            {"filter", selection.filters},
            {"set", selection.sets},
            {"seeds", selection.seeds},
            {"shard", selection.shard},
            {"cases", one_line(selection.list)},
            {"jobs", campaign.jobs},
            {"threads", campaign.threads},
            {"share_cores", campaign.share_cores},
            {"time_budget", campaign.time_budget},
            {"resume", campaign.resume},
            {"trace", campaign.trace},
            {"config", valid_text(text)},
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

/// The last line of a campaign that did not finish.
std::string go_on_text(const RunFlags& flags) {
  return flags.campaign.resume ? "the same command resumes"
                               : "the same command without --fresh resumes";
}

/// Runs the cases again outside the store, only for their times.
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
  for (int k = 1; k < flags.benchmark.repetitions; ++k) {
    const PassingStore passing(flags.campaign.out);
    again.out = passing.path();
    const auto r = run_campaign(prepared, again, flags.json(), screen);
    for (const CaseRecord& c : r.cases) {
      for (const StageRecord& s : c.stages) {
        const std::string name = c.info.name + "/" + s.stage;
        if (!has_result(s) || !hashes.contains(name)) continue;
        if (loss_bits(s) != hashes[name])
          throw std::logic_error(name + " gives other results when repeated");
        all[name + " " + s.key].push_back(s.clocks.solve);
      }
    }
    if (r.interrupted) break;
  }
  return all;
}

/// In the formats of Google Benchmark's flags.
void write_exports(const RunFlags& flags, bool to_screen) {
  const BenchmarkFlags& benchmark = flags.benchmark;
  if (!to_screen && benchmark.out.empty()) return;
  const Loaded loaded = load(flags.campaign.out.string(), stderr);
  if (to_screen) put(stdout, exported(loaded, benchmark.format));
  if (!benchmark.out.empty())
    write_atomically(benchmark.out, exported(loaded, benchmark.out_format));
}

Screen screen_of(const RunFlags& flags) {
  Screen screen =
      Screen::of(flags.benchmark.format == "console" ? stdout : stderr);
  screen.quiet = flags.quiet;
  screen.live = screen.live && !flags.quiet;
  return screen;
}

/// Experiments by name, or how many.
std::string experiments_text(const std::vector<Case>& cases) {
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> names;
  for (const Case& c : cases)
    if (std::find(names.begin(), names.end(), c.info.experiment) == names.end())
      names.push_back(c.info.experiment);
  return names.size() <= kNamed ? fmt::format("{}", fmt::join(names, ", "))
                                : fmt::format("{} experiments", names.size());
}

/// What is stored and may be reused.
std::optional<Catalog> reusable(const CampaignOptions& o) {
  if (!o.resume || !Store::exists(o.out)) return {};
  return Catalog::read(o.out);
}

/// What will run, at once.
std::string begin_text(const RunFlags& flags, const std::vector<Case>& cases) {
  const fs::path& out = flags.campaign.out;
  std::vector<Case> left = cases;
  if (const auto stored = reusable(flags.campaign))
    std::erase_if(
        left, [&](const Case& c) { return stored->knows_case(c.info.name); });
  return fmt::format("{}: {} cases of profile {}{}, {} workers{}\n",
                     experiments_text(cases),
                     cases.size(),
                     flags.selection.profile,
                     left.size() < cases.size()
                         ? fmt::format(" ({} have results in {})",
                                       cases.size() - left.size(),
                                       one_line(out.string()))
                         : "",
                     flags.campaign.jobs,
                     about_text(left, flags.campaign.jobs, durations_file()));
}

/// With keys only where something may be reused: the data of experiments that
/// the store does not have are not drawn.
Prepared prepared_to_look(std::vector<Case> cases, const CampaignOptions& o) {
  std::set<std::string> known;
  if (const auto stored = reusable(o))
    for (const Case& c : cases)
      if (stored->knows_case(c.info.name)) known.insert(c.info.experiment);
  const auto at =
      std::stable_partition(cases.begin(), cases.end(), [&](const Case& c) {
        return known.contains(c.info.experiment);
      });
  Prepared p = prepare({cases.begin(), at});
  p.cases.insert(p.cases.end(), at, cases.end());
  return p;
}

/// Why a run was not good or not complete.
std::optional<ExitError> ending_of(const RunFlags& flags,
                                   const CampaignResult& result,
                                   std::size_t cases) {
  if (result.interrupted)
    return ExitError(ExitCode::interrupted,
                     fmt::format("interrupted: {} of {} cases not run; "
                                 "finished stages are saved, {}",
                                 result.not_run.size(),
                                 cases,
                                 go_on_text(flags)));
  if (!result.failed.empty())
    return ExitError(
        ExitCode::case_failed,
        fmt::format("{} stages failed, first {}; the others are saved, and the "
                    "next run tries the failed ones again",
                    result.failed.size(),
                    result.failed.front()));
  if (!result.not_run.empty())
    return ExitError(
        ExitCode::incomplete,
        fmt::format(
            "incomplete: {} of {} cases not run within the time budget; {}",
            result.not_run.size(),
            cases,
            go_on_text(flags)));
  return {};
}

/// Files of cases name their publication, where it is known.
void cite(std::vector<Case>& cases) {
  Published published;
  try {
    published = Published(published_directory());
  } catch (const UsageError&) {  // a program without such files
  }
  for (Case& c : cases) {
    const auto* p = published.publication(c.experiment->citation.paper);
    if (p == nullptr) continue;
    c.info.about.paper = p->text();
    c.info.about.arxiv = p->arxiv;
  }
}

CampaignResult run_all(Prepared prepared,
                       const RunFlags& flags,
                       const Screen& screen) {
  const BudgetAlarm alarm(flags.campaign.time_budget);
  const bool repeats = flags.benchmark.repetitions > 1;
  CampaignResult result = run_campaign(repeats ? prepared : std::move(prepared),
                                       flags.campaign,
                                       flags.json(),
                                       screen);
  if (repeats && !result.interrupted)
    keep_repetitions(flags.campaign.out,
                     repeat(prepared, flags, result.cases, screen),
                     {.break_lock = flags.campaign.break_lock});
  result.interrupted =
      (result.interrupted || stop_signals() > 0) && !alarm.ended_it();
  return result;
}

/// Ctrl-C also works while the reader of a pipe blocks.
void say_what_runs(const RunFlags& flags,
                   const std::vector<Case>& cases,
                   const Screen& screen) {
  const std::string text = begin_text(flags, cases);
  const StopSignalWatch watch;
  put(screen.stream, text);
  if (stop_signals() > 0)
    throw ExitError(ExitCode::interrupted,
                    "interrupted before the first case; nothing was run");
}

/// Writes pages and lines; the error of the run, if any, takes precedence over
/// theirs.
void end_with(const RunFlags& flags,
              const std::vector<CaseRecord>& own,
              const Screen& screen,
              double until,
              const std::optional<ExitError>& ending) {
  if (flags.report && !own.empty() &&
      !(ending && ending->code() == ExitCode::interrupted)) {
    RunEnd end{.out = flags.campaign.out.string(),
               .selection = flags.selection,
               .experiments = {},
               .jobs = flags.campaign.jobs,
               .screen = screen,
               .until = until};
    for (const CaseRecord& c : own) end.experiments.insert(c.info.experiment);
    try {
      program().conclude(end);
    } catch (const std::exception&) {
      if (!ending) throw;
    }
  }
  if (ending) throw ExitError(*ending);
}

}  // namespace

ExitCode run_verb(const Arguments& arguments) {
  const Seconds begun = now();
  RunFlags flags;
  if (!parse("run",
             "Runs the cases of a profile and writes their results. The "
             "default verb.\nExit codes and environment: --help without verb.",
             flags.flags(),
             arguments))
    return ExitCode::good;
  flags.complete();
  if (flags.benchmark.list) {
    for (const Case& c : flags.selection.cases())
      fmt::print("{}\n", c.info.name);
    return ExitCode::good;
  }
  auto cases = flags.selection.cases(&flags.campaign.campaign);
  const Screen screen = screen_of(flags);
  if (flags.dry) {
    dry_run(prepared_to_look(std::move(cases), flags.campaign),
            flags.campaign,
            Screen::of(stdout));
    return ExitCode::good;
  }
  if (!flags.quiet) say_what_runs(flags, cases, screen);
  cite(cases);
  Prepared prepared = prepare(std::move(cases));
  const double until = flags.campaign.time_budget > 0
                           ? begun.wall + flags.campaign.time_budget
                           : std::numeric_limits<double>::infinity();
  if (flags.campaign.time_budget > 0)
    follow_budget(flags.campaign, prepared.cases, {begun, flags.report});
  std::vector<std::string> names;
  for (const Case& c : prepared.cases) names.push_back(c.info.name);
  CampaignResult result = run_all(std::move(prepared), flags, screen);
  const auto own = own_records(std::move(result.cases), names);
  put(screen.stream, summary_table(own, screen.room()));
  if (const auto text = crowded_text(own); !text.empty())
    put(screen.stream, text + '\n');
  put(screen.stream, result_text(flags, result));
  write_exports(flags, screen.stream != stdout);
  end_with(flags, own, screen, until, ending_of(flags, result, names.size()));
  return ExitCode::good;
}

}  // namespace physinv
