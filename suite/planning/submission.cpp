#include "suite/planning/submission.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "suite/harness/child.h"
#include "suite/harness/errors.h"
#include "suite/results/catalog.h"
#include "suite/results/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

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

std::string sbatch(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"sbatch", "--parsable"});
  const Ended r = run_child(arguments);
  if (r.status != 0) {
    std::string text = r.output + r.errors;
    std::replace(text.begin(), text.end(), '\n', ' ');
    throw EnvironmentError(
        fmt::format("sbatch refuses: {}", text.empty() ? "no answer" : text));
  }
  // Warnings may stand before the id, a cluster's name after it.
  std::istringstream lines(r.output);
  std::string id;
  for (std::string line; std::getline(lines, line);) id = line;
  return id.substr(0, id.find(';'));
}

}  // namespace

bool Submission::exists(const fs::path& directory) {
  return fs::exists(directory / "submission.json");
}

Submission Submission::read(const fs::path& directory) {
  if (!exists(directory))
    throw UsageError(fmt::format(
        "'{}' holds no submitted campaign; 'submit --slurm {}' makes one",
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
    for (const json& t : all.at("tasks"))
      s.tasks.push_back({t.at("cases").get<std::vector<std::string>>(),
                         t.at("seconds").get<double>()});
  } catch (const json::exception&) {
    throw StoreError(fmt::format(
        "{} is damaged (delete it and submit again: finished stages are kept)",
        (directory / "submission.json").string()));
  }
  return s;
}

void Submission::save() const {
  json all{{"program", program},
           {"selection", selection},
           {"running", running},
           {"jobs", jobs},
           {"tasks", json::array()}};
  for (const Task& t : tasks)
    all["tasks"].push_back({{"cases", t.cases}, {"seconds", t.seconds}});
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

std::vector<TaskState> states_of(const Submission& s) {
  std::vector<TaskState> states;
  for (std::size_t k = 0; k < s.tasks.size(); ++k) {
    TaskState state{.cases = s.tasks[k].cases.size(), .job = {}};
    if (fs::exists(s.shard(k) / "journal.jsonl")) {
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

void ask_queue(const Submission& s, std::vector<TaskState>& states) {
  if (s.jobs.empty() || !has_program("squeue")) return;
  const Ended queue = run_child({"squeue", "-h", "-r", "-o", "%F %K %T"});
  std::istringstream lines(queue.output);
  std::string job, task, state;
  while (lines >> job >> task >> state) {
    const bool ours =
        std::find(s.jobs.begin(), s.jobs.end(), job) != s.jobs.end();
    if (!ours || task.find_first_not_of("0123456789") != std::string::npos)
      continue;
    const std::size_t k = std::stoul(task);
    if (k < states.size()) states[k].job = state;
  }
}

std::string submit(const Submission& s,
                   const std::vector<std::size_t>& tasks,
                   const std::vector<std::string>& sbatch_options) {
  const fs::path log = s.directory / "log";
  std::vector<std::string> array = {
      fmt::format("--array={}", fmt::join(tasks, ",")),
      "--requeue",
      "--open-mode=append",
      "--job-name=physinv",
      "--output=" + (log / "task-%a.txt").string()};
  array.insert(array.end(), sbatch_options.begin(), sbatch_options.end());
  array.push_back((s.directory / "task.sh").string());
  const std::string id = sbatch(array);
  sbatch({"--dependency=afterany:" + id,
          "--requeue",
          "--open-mode=append",
          "--job-name=physinv-merge",
          "--output=" + (log / "merge.txt").string(),
          (s.directory / "merge.sh").string()});
  return id;
}

}  // namespace physinv
