#include "suite/planning/submission.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "suite/core/decimal.h"
#include "suite/harness/child.h"
#include "suite/harness/context.h"
#include "suite/harness/errors.h"
#include "suite/harness/output.h"
#include "suite/store/catalog.h"
#include "suite/store/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// sbatch replaces what follows a % in the names of output files: %% is one.
std::string output_pattern(const fs::path& directory) {
  std::string out;
  for (const char c : directory.string())
    out += c == '%' ? "%%" : std::string(1, c);
  return out;
}

/// What the largest of these tasks needs and a margin; nothing if the user
/// asks, or if it is known of no task.
std::string memory_option(const Submission& s,
                          const std::vector<std::size_t>& tasks,
                          const std::vector<std::string>& sbatch_options) {
  constexpr double kMargin = 1.5, kAtLeast = 256e6, kMega = 1024.0 * 1024;
  double most = 0;
  for (const std::size_t k : tasks) most = std::max(most, s.tasks[k].memory);
  const bool asked = std::any_of(
      sbatch_options.begin(), sbatch_options.end(), [](const auto& option) {
        return option.starts_with("--mem");
      });
  if (asked || !(most > 0)) return "";
  return fmt::format(
      "--mem={:.0f}M",
      std::ceil(std::max(kMargin * most, most + kAtLeast) / kMega));
}

/// For a shell.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

std::string quoted(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words) out += ' ' + quoted(word);
  return out;
}

/// What a kill ends is tried again, as finished stages are kept; 9 may be an
/// earlier try, on a node that was lost, that still holds the store.
constexpr std::string_view kTask = R"sh(#!/usr/bin/env bash
# A task of the array: its cases, from where an earlier try ended.
cd {directory} || exit 9
task=$SLURM_ARRAY_TASK_ID
for ((try = 1; try <= 5; ++try)); do
  {program} run{flags} --cases="tasks/$task.txt" --out="shards/$task"
  status=$?
  ((status == 9 || status >= 128)) && ((status != 130)) || exit "$status"
  echo "task $task ended with status $status, try $try" >&2
  sleep {pause}
done
exit "$status"
)sh";

constexpr std::string_view kMerge = R"sh(#!/usr/bin/env bash
# Joins what the tasks left, complete or not.
cd {directory} || exit 9
shards=()
for shard in shards/*/; do
  [[ ! -s $shard/journal.jsonl || ! -s $shard/plan.json ]] || shards+=("$shard")
done
exec {program} merge merged "${{shards[@]}}"
)sh";

std::string state_of(const Catalog& catalog, const std::string& name) {
  if (!catalog.knows_case(name)) return "";
  const CaseInfo info = catalog.info_of(name);
  for (std::size_t k = 0; k < info.stages.size(); ++k) {
    const JournalEntry* entry = catalog.at(name, static_cast<Index>(k));
    if (entry == nullptr) return "";
    if (!has_result(entry->stage)) return "failed";
  }
  return "done";
}

/// PHYSINV_SLURM_SECONDS, and what anyone could read of an answer.
ChildLimits slurm_limits() {
  constexpr double kUsual = 30, kLongest = 3600;
  constexpr const char* kName = "PHYSINV_SLURM_SECONDS";
  const std::string text = variable(kName);
  ChildLimits limits{.seconds = kUsual, .bytes = 16 << 20};
  if (text.empty()) return limits;
  limits.seconds = decimal<double>(text).value_or(0);
  if (!(limits.seconds > 0 && limits.seconds <= kLongest))
    throw UsageError(fmt::format(
        "{}={} is not a number of seconds up to {:g}", kName, text, kLongest));
  return limits;
}

bool is_number(std::string_view text) {
  return !text.empty() &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Could this program have written it?
bool is_sound(const Submission& s) {
  return std::all_of(s.jobs.begin(), s.jobs.end(), is_number) &&
         (s.merges_after.empty() || is_number(s.merges_after)) &&
         std::all_of(s.tasks.begin(), s.tasks.end(), [](const Task& t) {
           return t.seconds >= 0 && std::isfinite(t.seconds) && t.memory >= 0 &&
                  std::isfinite(t.memory);
         });
}

/// The id in what sbatch prints: warnings may come before it, a cluster's name
/// after it.
std::string job_id(const std::string& output) {
  constexpr std::size_t kLongestId = 20;
  std::istringstream lines(output);
  std::string id;
  for (std::string line; std::getline(lines, line);) id = line;
  id = id.substr(0, id.find(';'));
  if (!is_number(id) || id.size() > kLongestId)
    throw EnvironmentError(
        fmt::format("sbatch printed '{}' instead of a job id; check with "
                    "squeue whether it accepted the job",
                    one_line(id.substr(0, 100))));
  return id;
}

struct SlurmRefuses : EnvironmentError {
  using EnvironmentError::EnvironmentError;
};

/// " (MaxArraySize is 1001)" as scontrol prints it, or nothing.
std::string array_limit() {
  constexpr std::string_view kName = "MaxArraySize";
  if (!has_program("scontrol")) return "";
  const Ended r = run_child({"scontrol", "show", "config"}, slurm_limits());
  if (!r.exceeded.empty() || r.status != 0) return "";
  std::istringstream lines(r.output);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, equals, value;
    words >> name >> equals >> value;
    if (name == kName && is_number(value))
      return fmt::format(" (MaxArraySize is {}: task numbers stay below it)",
                         value);
  }
  return "";
}

std::string sbatch(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"sbatch", "--parsable"});
  const Ended r = run_child(arguments, slurm_limits());
  if (!r.exceeded.empty())
    throw EnvironmentError(
        fmt::format("sbatch does not respond ({}); check with squeue whether "
                    "it accepted the job, and raise PHYSINV_SLURM_SECONDS",
                    r.exceeded));
  if (r.status != 0) {
    const std::string text = r.output + r.errors;
    throw SlurmRefuses(fmt::format(
        "sbatch failed: {}",
        text.empty() ? "no message" : one_line(text.substr(0, 300))));
  }
  return job_id(r.output);
}

/// A line of the queue; nothing if it is none.
struct QueueLine {
  std::string job, task, state;
};
std::optional<QueueLine> queue_line(const std::string& text) {
  constexpr std::string_view kStates = "ABCDEFGHIJKLMNOPQRSTUVWXYZ_";
  constexpr std::size_t kLongestState = 32;
  std::istringstream words(text);
  QueueLine line;
  std::string more;
  words >> line.job >> line.task >> line.state;
  if (line.state.empty() || line.state.size() > kLongestState ||
      words >> more || !is_number(line.job) ||
      line.state.find_first_not_of(kStates) != std::string::npos)
    return {};
  return line;
}

/// Of a campaign's tasks; others, and "N/A" for a job that is not an array, are
/// none.
std::optional<std::size_t> task_number(const std::string& text,
                                       std::size_t tasks) {
  const auto value = decimal<std::size_t>(text);
  return value && *value < tasks ? value : std::nullopt;
}

/// The lines of an answer. Banners are passed over, but an answer of nothing
/// else is none.
std::optional<std::vector<QueueLine>> queue_lines(const std::string& output) {
  std::vector<QueueLine> found;
  bool others = false;
  std::istringstream lines(output);
  for (std::string text; std::getline(lines, text);) {
    if (auto line = queue_line(text))
      found.push_back(std::move(*line));
    else
      others = others || !text.empty();
  }
  if (found.empty() && others) return {};
  return found;
}

}  // namespace

bool Submission::exists(const fs::path& directory) {
  return is_there(directory / "submission.json");
}

Submission Submission::read(const fs::path& directory) {
  if (!exists(directory))
    throw UsageError(fmt::format(
        "'{}' contains no submitted campaign; 'submit --slurm {}' creates one",
        directory.string(),
        directory.string()));
  Submission s;
  s.directory = fs::absolute(directory);
  try {
    const json all = json::parse(read_file(directory / "submission.json"));
    s.program = all.at("program");
    s.selection = all.at("selection").get<std::vector<std::string>>();
    s.running = all.at("running").get<std::vector<std::string>>();
    s.jobs = all.at("jobs").get<std::vector<std::string>>();
    s.listed = all.value("listed", false);
    s.merges_after =
        all.value("merges_after", s.jobs.empty() ? "" : s.jobs.back());
    for (const json& t : all.at("tasks"))
      s.tasks.push_back({t.at("cases").get<std::vector<std::string>>(),
                         t.at("seconds").get<double>(),
                         t.value("memory", 0.0)});
    if (is_sound(s)) return s;
  } catch (const json::exception&) {
  }
  throw StoreError(fmt::format(
      "{} is damaged (delete it and submit again: finished stages are reused)",
      (directory / "submission.json").string()));
}

void Submission::save() const {
  json all{{"program", program},
           {"selection", selection},
           {"running", running},
           {"jobs", jobs},
           {"merges_after", merges_after},
           {"listed", listed},
           {"tasks", json::array()}};
  for (const Task& t : tasks)
    all["tasks"].push_back(
        {{"cases", t.cases}, {"seconds", t.seconds}, {"memory", t.memory}});
  write_atomically(directory / "submission.json", all.dump(1) + "\n");
}

void Submission::write() const {
  for (const char* folder : {"tasks", "shards", "log"})
    make_directory(directory / folder);
  for (std::size_t k = 0; k < tasks.size(); ++k)
    write_atomically(directory / "tasks" / fmt::format("{}.txt", k),
                     fmt::format("{}\n", fmt::join(tasks[k].cases, "\n")));
  std::vector<std::string> flags = selection;
  flags.insert(flags.end(), running.begin(), running.end());
  const std::string here = quoted(directory.string());
  write_atomically(directory / "task.sh",
                   fmt::format(fmt::runtime(kTask),
                               fmt::arg("directory", here),
                               fmt::arg("program", quoted(program)),
                               fmt::arg("flags", quoted(flags)),
                               fmt::arg("pause", 3)));
  write_atomically(directory / "merge.sh",
                   fmt::format(fmt::runtime(kMerge),
                               fmt::arg("directory", here),
                               fmt::arg("program", quoted(program))));
  save();
}

fs::path Submission::shard(std::size_t task) const {
  return directory / "shards" / std::to_string(task);
}

void require_expressible(const fs::path& directory) {
  if (directory.string().find('\\') != std::string::npos)
    throw UsageError(
        fmt::format("Slurm interprets backslashes in file names; choose a name "
                    "without them instead of '{}'",
                    directory.string()));
}

std::vector<TaskState> states_of(const Submission& s) {
  std::vector<TaskState> states;
  for (std::size_t k = 0; k < s.tasks.size(); ++k) {
    TaskState state{.cases = s.tasks[k].cases.size(), .job = {}};
    if (is_there(s.shard(k) / "journal.jsonl")) {
      const Catalog catalog = Catalog::read(s.shard(k));
      for (const auto& name : s.tasks[k].cases) {
        const std::string is = state_of(catalog, name);
        if (is == "done") ++state.done;
        if (is == "failed") ++state.failed;
      }
    }
    states.push_back(std::move(state));
  }
  return states;
}

std::string ask_queue(const Submission& s, std::vector<TaskState>& states) {
  if (s.jobs.empty()) return "";
  if (!has_program("squeue")) return "there is no squeue in PATH";
  const Ended queue =
      run_child({"squeue", "-h", "-r", "-o", "%F %K %T"}, slurm_limits());
  if (!queue.exceeded.empty())
    return fmt::format("squeue does not respond ({})", queue.exceeded);
  if (queue.status != 0)
    return fmt::format("squeue exited with status {} {}",
                       queue.status,
                       one_line(queue.errors));
  const auto lines = queue_lines(queue.output);
  if (!lines) return "squeue printed something other than a queue";
  for (const QueueLine& line : *lines) {
    const auto task = task_number(line.task, states.size());
    if (task &&
        std::find(s.jobs.begin(), s.jobs.end(), line.job) != s.jobs.end())
      states[*task].job = line.state;
  }
  return "";
}

std::string submit_array(const Submission& s,
                         const std::vector<std::size_t>& tasks,
                         const std::vector<std::string>& sbatch_options) {
  std::vector<std::string> array = {
      fmt::format("--array={}", fmt::join(tasks, ",")),
      "--requeue",
      "--open-mode=append",
      "--job-name=physinv",
      "--output=" + output_pattern(s.directory) + "/log/task-%a.txt"};
  if (const auto memory = memory_option(s, tasks, sbatch_options);
      !memory.empty())
    array.push_back(memory);
  array.insert(array.end(), sbatch_options.begin(), sbatch_options.end());
  array.push_back((s.directory / "task.sh").string());
  try {
    return sbatch(array);
  } catch (const SlurmRefuses& error) {
    throw EnvironmentError(fmt::format(
        "{}; {} tasks were requested{}: change --tasks, --jobs or --threads in "
        "the next submit, or add options of sbatch after --",
        error.what(),
        tasks.size(),
        array_limit()));
  }
}

void submit_merge(const Submission& s, const std::string& after) {
  std::vector<std::string> merge = {
      "--requeue",
      "--open-mode=append",
      "--job-name=physinv-merge",
      "--output=" + output_pattern(s.directory) + "/log/merge.txt",
      (s.directory / "merge.sh").string()};
  if (!after.empty())
    merge.insert(merge.begin(), "--dependency=afterany:" + after);
  sbatch(std::move(merge));
}

}  // namespace physinv
