#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <set>

#include "suite/app/options.h"
#include "suite/app/speeds.h"
#include "suite/harness/child.h"
#include "suite/harness/progress.h"
#include "suite/planning/forecast.h"
#include "suite/planning/split.h"
#include "suite/planning/submission.h"
#include "suite/store/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

struct SubmitFlags {
  Selection selection;
  std::string directory;
  int tasks = 16, jobs = 1, threads = 1;
  bool share_cores = false;
};

std::vector<std::string> flags_of(const Selection& s) {
  std::vector<std::string> flags = {"--profile=" + s.profile};
  for (const auto& f : s.filters) flags.push_back("--filter=" + f);
  for (const auto& f : s.sets) flags.push_back("--set=" + f);
  if (!s.seeds.empty()) flags.push_back("--seeds=" + s.seeds);
  if (s.all) flags.emplace_back("--all");
  return flags;
}

/// By this machine's speed; the nodes' is a common factor. A task needs the
/// memory of as many of its largest cases as it has workers.
std::vector<Task> tasks_of(const std::vector<Case>& cases,
                           int count,
                           int jobs) {
  const auto costs = costs_without_runs(cases);
  const auto seconds = weights_of(cases, costs);
  const Split split =
      split_longest_first(seconds, static_cast<std::size_t>(count));
  std::vector<Task> tasks;
  for (const auto& items : split.tasks) {
    Task task;
    std::vector<double> memory;
    for (const std::size_t i : items) {
      task.cases.push_back(cases[i].info.name);
      task.seconds += seconds[i];
      memory.push_back(costs[i].memory);
    }
    std::sort(memory.begin(), memory.end(), std::greater<>());
    memory.resize(std::min(memory.size(), static_cast<std::size_t>(jobs)));
    task.memory = std::accumulate(memory.begin(), memory.end(), 0.0);
    tasks.push_back(std::move(task));
  }
  return tasks;
}

/// The cases of a list are not in the flags.
void require_same(const Submission& s, const std::vector<Case>& cases) {
  std::set<std::string> before, now;
  for (const Task& task : s.tasks)
    before.insert(task.cases.begin(), task.cases.end());
  for (const Case& c : cases) now.insert(c.info.name);
  if (before == now) return;
  const auto lacks = [](const auto& a, const auto& b) {
    return *std::find_if(a.begin(), a.end(), [&](const auto& name) {
      return !b.contains(name);
    });
  };
  const bool fewer =
      std::includes(before.begin(), before.end(), now.begin(), now.end());
  throw UsageError(
      fmt::format("{} was submitted with {} cases, but {} are selected now: {} "
                  "is {}; give the same list to run missing cases, or another "
                  "directory for another campaign",
                  s.directory.string(),
                  before.size(),
                  now.size(),
                  fewer ? lacks(before, now) : lacks(now, before),
                  fewer ? "left out" : "new"));
}

/// A split of these cases, in files.
Submission written(const SubmitFlags& flags,
                   const std::vector<std::string>& selection,
                   const std::vector<Case>& cases) {
  Submission s{.directory = fs::absolute(flags.directory),
               .program = fs::read_symlink("/proc/self/exe").string(),
               .selection = selection,
               .running = {fmt::format("--jobs={}", flags.jobs),
                           fmt::format("--threads={}", flags.threads)},
               .tasks = tasks_of(cases, flags.tasks, flags.jobs),
               .jobs = {},
               .merges_after = {},
               .listed = !flags.selection.list.empty()};
  if (flags.share_cores) s.running.emplace_back("--share-cores");
  require_expressible(s.directory);
  make_directory(s.directory);
  s.write();
  return s;
}

Submission prepare_submission(SubmitFlags& flags) {
  const auto selection = flags_of(flags.selection);
  const auto cases = flags.selection.cases();
  if (Submission::exists(flags.directory)) {
    Submission s = Submission::read(flags.directory);
    if (!flags.selection.list.empty() || s.listed) require_same(s, cases);
    // Nothing was taken yet: another split may suit Slurm's limits.
    if (selection == s.selection && s.jobs.empty() &&
        fs::is_empty(s.directory / "shards"))
      return written(flags, selection, cases);
    if (selection != s.selection)
      throw UsageError(fmt::format(
          "{} was submitted with {}; give the same flags to run missing cases, "
          "or another directory for another campaign",
          flags.directory,
          fmt::join(s.selection, " ")));
    return s;
  }
  return written(flags, selection, cases);
}

std::vector<std::size_t> missing_tasks(const std::vector<TaskState>& states) {
  std::vector<std::size_t> missing;
  for (std::size_t k = 0; k < states.size(); ++k)
    if (!states[k].complete() && states[k].job.empty()) missing.push_back(k);
  return missing;
}

void require_slurm() {
  if (!has_program("sbatch"))
    throw EnvironmentError(
        "Slurm is not installed (no sbatch in PATH); run on a login node of "
        "the cluster, or use --shard and merge");
}

/// The array's id is kept before anything else can go wrong: what is in the
/// queue is not submitted again.
void submit_missing(Submission& s,
                    const std::vector<std::size_t>& missing,
                    const std::vector<std::string>& sbatch_options) {
  double longest = 0, sum = 0;
  for (const std::size_t k : missing) {
    longest = std::max(longest, s.tasks[k].seconds);
    sum += s.tasks[k].seconds;
  }
  s.jobs.push_back(submit_array(s, missing, sbatch_options));
  s.save();
  fmt::print(
      "job {}: {} of {} tasks, {} of one core, the longest {}; then a "
      "merge into {}\n",
      s.jobs.back(),
      missing.size(),
      s.tasks.size(),
      duration_text(sum),
      duration_text(longest),
      (s.directory / "merged").string());
}

bool in_queue(const std::vector<TaskState>& states) {
  return std::any_of(states.begin(), states.end(), [](const TaskState& t) {
    return !t.job.empty();
  });
}

/// One merge for each array; if it still runs, after it.
void merge_after_last(Submission& s, bool runs) {
  if (s.jobs.empty() || s.merges_after == s.jobs.back()) return;
  try {
    submit_merge(s, runs ? s.jobs.back() : "");
  } catch (const EnvironmentError& error) {
    throw EnvironmentError(
        fmt::format("job {} is submitted, but its merge is not: {}; repeat the "
                    "command to submit it",
                    s.jobs.back(),
                    error.what()));
  }
  s.merges_after = s.jobs.back();
  s.save();
}

}  // namespace

ExitCode submit_verb(const Arguments& arguments) {
  const auto dashes = std::find(arguments.begin(), arguments.end(), "--");
  const Arguments own(arguments.begin(), dashes);
  const std::vector<std::string> sbatch_options(
      dashes == arguments.end() ? dashes : dashes + 1, arguments.end());
  SubmitFlags flags;
  if (!parse("submit",
             "Splits a campaign by predicted time, longest case first, and "
             "submits it to Slurm: an array of tasks, which resume after an "
             "interruption, and a merge. The same command submits again what "
             "is missing. Put options of sbatch after --.",
             flags.selection.flags(
                 {{"--slurm",
                   "the campaign's directory, on a file system that all nodes "
                   "share",
                   &flags.directory,
                   "DIR"},
                  {"--tasks",
                   "tasks of the array (default 16, at most one per case)",
                   &flags.tasks},
                  {"-j,--jobs",
                   "worker processes of a task (default 1)",
                   &flags.jobs},
                  {"--threads",
                   "threads inside a case (default 1)",
                   &flags.threads},
                  {"--share-cores",
                   "once no case of a task waits, give its free cores to its "
                   "running cases, as in run",
                   &flags.share_cores}}),
             own))
    return ExitCode::good;
  if (flags.directory.empty())
    throw UsageError("submit needs a directory: --slurm=DIR");
  if (!flags.selection.shard.empty())
    throw UsageError(
        "submit splits the cases itself; use --shard only with run");
  require_slurm();
  Submission s = prepare_submission(flags);
  auto states = states_of(s);
  if (const auto unknown = ask_queue(s, states); !unknown.empty())
    throw EnvironmentError(fmt::format(
        "{}; submitting without knowing the queue could run tasks twice",
        unknown));
  const auto missing = missing_tasks(states);
  if (!missing.empty())
    submit_missing(s, missing, sbatch_options);
  else if (!s.jobs.empty() && s.merges_after != s.jobs.back())
    fmt::print("submitting the missing merge\n");
  else
    fmt::print("all missing tasks are in the queue; see {} status {}\n",
               program().name,
               flags.directory);
  merge_after_last(s, !missing.empty() || in_queue(states));
  return ExitCode::good;
}

ExitCode status_verb(const Arguments& arguments) {
  std::string directory;
  if (!parse("status",
             "Prints the progress of a submitted campaign from its stored "
             "results and Slurm's queue. Exit 0 if all cases are done, 4 if a "
             "case failed, 10 if some are missing.",
             {{"DIR", "directory that 'submit' wrote", &directory}},
             arguments))
    return ExitCode::good;
  const Submission s = Submission::read(directory);
  auto states = states_of(s);
  const std::string unknown = ask_queue(s, states);
  std::size_t cases = 0, done = 0, failed = 0, queued = 0;
  fmt::print("{:>5}  {:>6}  {:>6}  {:>6}  {}\n",
             "task",
             "cases",
             "done",
             "failed",
             "state");
  for (std::size_t k = 0; k < states.size(); ++k) {
    const TaskState& t = states[k];
    fmt::print("{:>5}  {:>6}  {:>6}  {:>6}  {}\n",
               k,
               t.cases,
               t.done,
               t.failed,
               !t.job.empty() ? t.job
               : t.complete() ? "done"
               : t.failed > 0 ? "failed"
                              : "missing");
    cases += t.cases, done += t.done, failed += t.failed;
    queued += t.job.empty() ? 0 : 1;
  }
  fmt::print("{} of {} cases done, {} failed; {}\n",
             done,
             cases,
             failed,
             unknown.empty() ? fmt::format("{} tasks in the queue", queued)
                             : "the state of the queue is unknown: " + unknown);
  if (failed > 0 && queued == 0)
    throw ExitError(ExitCode::case_failed,
                    fmt::format("{} cases failed; their tasks' logs are in {}",
                                failed,
                                (s.directory / "log").string()));
  if (done < cases)
    throw ExitError(
        ExitCode::incomplete,
        fmt::format("incomplete: {} of {} cases are not done; {}",
                    cases - done,
                    cases,
                    !unknown.empty() ? unknown
                    : queued > 0     ? "tasks are in the queue"
                                 : "repeat 'submit' to run the missing cases"));
  return ExitCode::good;
}

}  // namespace physinv
