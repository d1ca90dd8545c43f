/// Worker processes. Each is forked from the parent before it has any thread,
/// runs the cases it is handed one after the other, and sends every finished
/// stage back at once. A worker that dies is replaced; all die with the parent.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>
#include <vector>

#include "suite/harness/run_case.h"
#include "suite/harness/wire.h"

namespace physinv {

/// What a worker reports.
struct WorkerEvent {
  enum class Kind {
    stage_started,
    progress,
    stage_done,
    case_done,
    left,  ///< as `ask_to_leave` asked; submitted again, the case continues
    died
  };
  Kind kind{};
  std::size_t worker = 0, case_index = 0;
  Index position = 0;    ///< of the stage
  Index iteration = 0;   ///< progress
  double loss = 0;       ///< progress: median of the examples
  double overhead = 0;   ///< case_done: CPU seconds in no stage
  StageRecord record;    ///< stage_done
  std::string message;   ///< died: how
  bool killed = false;   ///< died: by SIGKILL, so from outside
  bool crashed = false;  ///< died: by a signal that it raised itself
};

class Workers {
 public:
  /// `cases` must outlive the workers, and its content keys be filled in.
  /// Throws EnvironmentError if there are not so many processes or sockets.
  Workers(const std::vector<Case>& cases,
          std::size_t count,
          int threads,
          RunOptions options);
  /// Kills and collects all.
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  std::size_t count() const { return workers_.size(); }
  bool idle(std::size_t worker) const { return !workers_[worker].busy; }
  pid_t process(std::size_t worker) const { return workers_[worker].pid; }

  /// Hands a case to an idle worker, to run in so many threads, or in those it
  /// has if they cannot all start; `earlier` are the stages it need not run.
  void submit(std::size_t worker,
              std::size_t case_index,
              const std::vector<StageRecord>& earlier,
              int threads);

  /// A worker that has started a stage leaves its case as soon as a stage has
  /// saved its state or ended; never, if none does.
  void ask_to_leave(std::size_t worker);
  /// Running stages save their state where they can, and their workers leave:
  /// they die and are not replaced.
  void dismiss();
  /// Is a worker busy with a case?
  bool busy() const;

  /// Waits up to `seconds` (or a signal) and returns what arrived. Throws
  /// EnvironmentError if a worker has not the threads it needs.
  std::vector<WorkerEvent> wait(double seconds);

 private:
  struct Worker {
    pid_t pid = -1;
    int socket = -1;
    bool busy = false;
    std::size_t case_index = 0;
    std::unique_ptr<Inbox> inbox;
  };
  void start(Worker& worker);
  void end();
  /// How it ended, as waitpid has it.
  int collect(Worker& worker);

  const std::vector<Case>& cases_;
  int threads_;
  RunOptions options_;
  std::vector<Worker> workers_;
  int idle_deaths_ = 0;
  bool dismissed_ = false;
};

}  // namespace physinv
