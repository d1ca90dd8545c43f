#include "suite/harness/workers.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <system_error>

#include "suite/core/clock.h"
#include "suite/core/float_environment.h"
#include "suite/harness/errors.h"
#include "suite/store/json.h"

namespace physinv {
namespace {

constexpr int kDismissal = SIGUSR1, kLeaveAsked = SIGUSR2;

enum Kind : std::uint32_t {
  kRun,
  kStageStarted,
  kProgress,
  kStageDone,
  kCaseDone,
  kCaseLeft,
  kCannotStart
};

/// Set by the signals that dismiss a worker and ask it to leave a case.
volatile std::sig_atomic_t dismissed = 0, leave_asked = 0;

Leaving asked() {
  return dismissed != 0     ? Leaving::now
         : leave_asked != 0 ? Leaving::if_saved
                            : Leaving::no;
}

/// If not all can start, a case continues with those that did.
void set_count(std::unique_ptr<Threads>& threads, int count) {
  if (threads->count() == count) return;
  try {
    threads = std::make_unique<Threads>(count);
  } catch (const std::system_error&) {
  }
}

/// The worker's side: cases in, stages out, until the parent closes.
void serve(int socket,
           const std::vector<Case>& cases,
           std::unique_ptr<Threads> threads,
           const RunOptions& options) {
  while (const auto message = receive_message(socket)) {
    leave_asked = 0;  // it was for the case before
    const double begin = now().cpu;
    double in_stages = 0;
    BodyReader body(message->body);
    const auto index = body.get<std::uint64_t>();
    set_count(threads, body.get<int>());
    std::vector<StageRecord> earlier(body.get<std::uint64_t>());
    for (auto& record : earlier) record = from_wire(body.bytes());
    const CaseHooks hooks{
        .started =
            [&](Index position) {
              send_message(
                  socket, kStageStarted, BodyWriter().put(position).take());
            },
        .progress =
            [&](Index iteration, double loss) {
              send_message(socket,
                           kProgress,
                           BodyWriter().put(iteration).put(loss).take());
            },
        .finished =
            [&](const StageRecord& record) {
              in_stages += record.clocks.total().cpu;
              send_message(socket, kStageDone, to_wire(record));
            }};
    try {
      run_case(cases[index], std::move(earlier), options, threads.get(), hooks);
    } catch (const StageLeft&) {
      if (dismissed != 0) throw;
      send_message(socket, kCaseLeft, {});
      continue;
    }
    // What a stage was restored with counts as its own, but not as ours.
    const double overhead = std::max(0.0, now().cpu - begin - in_stages);
    send_message(socket, kCaseDone, BodyWriter().put(overhead).take());
  }
}

/// The worker's threads; if there are too few, the parent learns why.
std::unique_ptr<Threads> start_threads(int socket, int count) {
  try {
    return std::make_unique<Threads>(count);
  } catch (const std::exception& error) {
    const std::string_view text = error.what();
    send_message(socket,
                 kCannotStart,
                 std::vector<std::uint8_t>(text.begin(), text.end()));
    throw;
  }
}

/// SIGINT and SIGTERM are the parent's to handle, and its files its own.
void become_worker(int socket, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);  // it died before the line above
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  struct sigaction action {};
  action.sa_handler = [](int) { dismissed = 1; };
  action.sa_flags = SA_RESTART;
  sigaction(kDismissal, &action, nullptr);
  action.sa_handler = [](int) { leave_asked = 1; };
  sigaction(kLeaveAsked, &action, nullptr);
  const auto s = static_cast<unsigned>(socket);
  if (s > 3) close_range(3, s - 1, 0);
  close_range(s + 1, ~0U, 0);
}

WorkerEvent decode(const Message& message) {
  WorkerEvent event;
  BodyReader body(message.body);
  switch (message.kind) {
    case kStageStarted:
      event.kind = WorkerEvent::Kind::stage_started;
      event.position = body.get<Index>();
      break;
    case kProgress:
      event.kind = WorkerEvent::Kind::progress;
      event.iteration = body.get<Index>();
      event.loss = body.get<double>();
      break;
    case kStageDone:
      event.kind = WorkerEvent::Kind::stage_done;
      event.record = from_wire(message.body);
      event.position = event.record.position;
      break;
    case kCaseLeft:
      event.kind = WorkerEvent::Kind::left;
      break;
    case kCannotStart:
      throw EnvironmentError(fmt::format(
          "a worker cannot start: {}; try fewer --threads or --jobs",
          std::string(message.body.begin(), message.body.end())));
    default:
      event.kind = WorkerEvent::Kind::case_done;
      event.overhead = body.get<double>();
  }
  return event;
}

std::string death_text(int status) {
  if (WIFSIGNALED(status)) {
    const char* name = sigabbrev_np(WTERMSIG(status));
    const std::string signal = name != nullptr
                                   ? fmt::format("SIG{}", name)
                                   : fmt::format("signal {}", WTERMSIG(status));
    return "the worker was killed by " + signal +
           (WTERMSIG(status) == SIGKILL ? " (out of memory?)" : "");
  }
  return fmt::format("the worker exited with status {}", WEXITSTATUS(status));
}

}  // namespace

Workers::Workers(const std::vector<Case>& cases,
                 std::size_t count,
                 int threads,
                 RunOptions options)
    : cases_(cases),
      threads_(threads),
      options_(std::move(options)),
      workers_(count) {
  options_.threads = threads;
  options_.checkpoints.leaving = asked;
  try {
    for (Worker& worker : workers_) start(worker);
  } catch (...) {
    end();
    throw;
  }
}

Workers::~Workers() { end(); }

void Workers::end() {
  for (Worker& worker : workers_) {
    if (worker.pid <= 0) continue;
    kill(worker.pid, SIGKILL);
    collect(worker);
  }
}

void Workers::start(Worker& worker) {
  int pair[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
    throw EnvironmentError(fmt::format(
        "cannot create a socket for a worker ({}); try fewer --jobs",
        std::strerror(errno)));
  std::fflush(nullptr);
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) {
    close(pair[0]), close(pair[1]);
    throw EnvironmentError(
        fmt::format("cannot create a worker process ({}); try fewer --jobs",
                    std::strerror(errno)));
  }
  if (pid == 0) {
    become_worker(pair[1], parent);
    set_default_float_environment();  // of its threads, too
    try {
      serve(pair[1], cases_, start_threads(pair[1], threads_), options_);
    } catch (const StageLeft&) {
    } catch (...) {
      _exit(static_cast<int>(ExitCode::internal));
    }
    _exit(0);
  }
  close(pair[1]);
  worker = {.pid = pid,
            .socket = pair[0],
            .busy = false,
            .case_index = 0,
            .inbox = std::make_unique<Inbox>()};
}

int Workers::collect(Worker& worker) {
  int status = 0;
  while (waitpid(worker.pid, &status, 0) < 0 && errno == EINTR) {
  }
  close(worker.socket);
  worker.pid = -1, worker.socket = -1;
  return status;
}

void Workers::ask_to_leave(std::size_t worker) {
  if (workers_[worker].pid > 0) kill(workers_[worker].pid, kLeaveAsked);
}

void Workers::dismiss() {
  dismissed_ = true;
  for (const Worker& worker : workers_)
    if (worker.pid > 0) kill(worker.pid, kDismissal);
}

bool Workers::busy() const {
  return std::any_of(workers_.begin(), workers_.end(), [](const Worker& w) {
    return w.pid > 0 && w.busy;
  });
}

void Workers::submit(std::size_t worker,
                     std::size_t case_index,
                     const std::vector<StageRecord>& earlier,
                     int threads) {
  BodyWriter body;
  body.put(static_cast<std::uint64_t>(case_index));
  body.put(threads);
  body.put(static_cast<std::uint64_t>(earlier.size()));
  for (const auto& record : earlier) body.bytes(to_wire(record));
  Worker& w = workers_[worker];
  w.busy = true;
  w.case_index = case_index;
  // If it has ended, the next `wait` notices.
  send_message(w.socket, kRun, body.take());
}

std::vector<WorkerEvent> Workers::wait(double seconds) {
  std::vector<pollfd> polled;
  for (const Worker& w : workers_) polled.push_back({w.socket, POLLIN, 0});
  poll(polled.data(), polled.size(), static_cast<int>(1e3 * seconds));

  std::vector<WorkerEvent> events;
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    if (polled[i].revents == 0) continue;
    Worker& w = workers_[i];
    const bool alive = w.inbox->fill(w.socket);
    while (const auto message = w.inbox->next()) {
      WorkerEvent event = decode(*message);
      event.worker = i;
      event.case_index = w.case_index;
      if (event.kind == WorkerEvent::Kind::case_done ||
          event.kind == WorkerEvent::Kind::left)
        w.busy = false;
      events.push_back(std::move(event));
    }
    if (alive) continue;
    WorkerEvent event;
    event.kind = WorkerEvent::Kind::died;
    event.worker = i;
    event.case_index = w.case_index;
    const int status = collect(w);
    event.message = death_text(status);
    event.killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    event.crashed = WIFSIGNALED(status) && WTERMSIG(status) != SIGKILL;
    if (w.busy) {
      events.push_back(std::move(event));
    } else if (++idle_deaths_ > 3) {
      throw EnvironmentError(event.message + " while idle, repeatedly");
    }
    if (!dismissed_) start(w);
  }
  return events;
}

}  // namespace physinv
