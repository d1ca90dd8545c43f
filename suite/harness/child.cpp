#include "suite/harness/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <sstream>

#include "suite/core/clock.h"
#include "suite/harness/context.h"

extern char** environ;

namespace physinv {
namespace {

/// Milliseconds for poll: -1 waits for ever, 0 is over.
int milliseconds_until(double end) {
  const double left = 1e3 * (end - now().wall);
  return std::isinf(left) ? -1 : static_cast<int>(std::clamp(left, 0.0, 1e6));
}

std::string too_long(const ChildLimits& limits) {
  return fmt::format("no exit within {:g} s", limits.seconds);
}

/// Reads both until both have ended, so that neither fills up. Returns the
/// limit that they exceed, if one.
std::string drain(std::array<pollfd, 2> ends,
                  std::array<std::string*, 2> texts,
                  const ChildLimits& limits,
                  double last) {
  std::array<char, 4096> chunk{};
  int open = 2;
  while (open > 0) {
    const int ready = poll(ends.data(), ends.size(), milliseconds_until(last));
    if (ready < 0 && errno != EINTR) return "cannot read its output";
    if (ready <= 0 && milliseconds_until(last) == 0) return too_long(limits);
    for (std::size_t i = 0; ready > 0 && i < ends.size(); ++i) {
      if (ends[i].fd < 0 || ends[i].revents == 0) continue;
      const ssize_t got = read(ends[i].fd, chunk.data(), chunk.size());
      if (got > 0) {
        texts[i]->append(chunk.data(), static_cast<std::size_t>(got));
        if (texts[i]->size() > limits.bytes)
          return fmt::format("more than {} bytes of output", limits.bytes);
      } else if (got == 0 || errno != EINTR) {
        ends[i].fd = -1;
        --open;
      }
    }
  }
  return "";
}

/// Its status as waitpid gives it; kills it if it still runs at `last`, which
/// it may do without any output.
int wait_until(pid_t pid, double last, bool& killed) {
  int status = 0;
  while (true) {
    const bool for_ever = std::isinf(last) || killed;
    const pid_t ended = waitpid(pid, &status, for_ever ? 0 : WNOHANG);
    if (ended == pid || (ended < 0 && errno != EINTR)) return status;
    if (!for_ever && milliseconds_until(last) == 0) {
      kill(pid, SIGKILL);
      killed = true;
    } else if (!for_ever) {
      poll(nullptr, 0, 1);
    }
  }
}

}  // namespace

Ended run_child(std::vector<std::string> arguments, const ChildLimits& limits) {
  Ended ended;
  int out[2], err[2];
  if (pipe2(out, O_CLOEXEC) != 0) return ended;
  if (pipe2(err, O_CLOEXEC) != 0) {
    close(out[0]), close(out[1]);
    return ended;
  }
  std::vector<char*> argv;
  for (auto& a : arguments) argv.push_back(a.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out[1], 1);
  posix_spawn_file_actions_adddup2(&actions, err[1], 2);
  pid_t pid = 0;
  const int error =
      posix_spawnp(&pid, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(out[1]), close(err[1]);
  if (error == 0) {
    const double last = now().wall + limits.seconds;
    ended.exceeded =
        drain({pollfd{out[0], POLLIN, 0}, pollfd{err[0], POLLIN, 0}},
              {&ended.output, &ended.errors},
              limits,
              last);
    bool killed = !ended.exceeded.empty();
    if (killed) kill(pid, SIGKILL);
    const int status = wait_until(pid, last, killed);
    if (killed && ended.exceeded.empty()) ended.exceeded = too_long(limits);
    ended.status =
        WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  close(out[0]), close(err[0]);
  return ended;
}

bool has_program(const std::string& name) {
  std::istringstream folders(variable("PATH"));
  std::string folder;
  while (std::getline(folders, folder, ':'))
    if (access((std::filesystem::path(folder) / name).c_str(), X_OK) == 0)
      return true;
  return false;
}

}  // namespace physinv
