/// A campaign on a cluster: its tasks in files, so that workers, and users who
/// ask for its state, need only a shared file system.
///
///   DIR/submission.json  the command, the tasks' cases and the jobs
///   DIR/tasks/K.txt      names of the cases of task K
///   DIR/shards/K/        its store         DIR/log/  output of the jobs
///   DIR/task.sh, merge.sh                  DIR/merged/  the whole campaign
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace physinv {

struct Task {
  std::vector<std::string> cases;
  double seconds = 0;  ///< predicted; by operations where not known
  double memory = 0;   ///< bytes of its workers, without a margin
};

struct Submission {
  std::filesystem::path directory;
  std::string program;                 ///< what runs a task
  std::vector<std::string> selection;  ///< flags that choose the cases
  std::vector<std::string> running;    ///< flags such as --threads=2
  std::vector<Task> tasks;
  std::vector<std::string> jobs;  ///< ids of the arrays submitted so far
  std::string merges_after;  ///< id of the last array with a merge after it
  bool listed = false;       ///< the cases are those of a --cases file

  static bool exists(const std::filesystem::path& directory);
  /// UsageError if there is none, StoreError if it is damaged.
  static Submission read(const std::filesystem::path& directory);
  /// All files but stores and logs.
  void write() const;
  /// submission.json alone.
  void save() const;
  std::filesystem::path shard(std::size_t task) const;
};

/// The state of a task, from what its store holds.
struct TaskState {
  std::size_t done = 0;    ///< cases all of whose stages have a result
  std::size_t failed = 0;  ///< cases with a stage that failed
  std::size_t cases = 0;
  std::string job;  ///< as the queue says: RUNNING, PENDING; empty: not there
  bool complete() const { return done == cases; }
};
std::vector<TaskState> states_of(const Submission& submission);

/// Asks Slurm's queue for the states of tasks. Returns why it is not known, or
/// an empty text; the states then stay as they are.
std::string ask_queue(const Submission& submission,
                      std::vector<TaskState>& states);

/// UsageError if sbatch cannot be given the names of files in this directory.
void require_expressible(const std::filesystem::path& directory);

/// Submits an array of these tasks and returns its job id. EnvironmentError if
/// Slurm refuses, or answers within PHYSINV_SLURM_SECONDS with nothing that is
/// an id.
std::string submit_array(const Submission& submission,
                         const std::vector<std::size_t>& tasks,
                         const std::vector<std::string>& sbatch_options);

/// Submits a merge; with `after`, once that array has ended, whatever becomes
/// of it.
void submit_merge(const Submission& submission, const std::string& after);

}  // namespace physinv
