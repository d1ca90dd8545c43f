#include "suite/store/thread_log.h"

#include <fmt/format.h>

namespace physinv {

void note_threads(ThreadLog& log, Index iteration, int threads) {
  if (!log.empty() && log.back().first == iteration) log.pop_back();
  if (log.empty() || log.back().second != threads)
    log.emplace_back(iteration, threads);
}

std::string changes_text(const ThreadLog& log, int usual) {
  std::string text;
  for (const auto& [iteration, threads] : log) {
    if (text.empty() && threads == usual) continue;
    text += fmt::format(
        "{}{} from iteration {}", text.empty() ? "" : ", ", threads, iteration);
  }
  return text;
}

bool is_thread_log(const ThreadLog& log) {
  Index before = -1;
  for (const auto& [iteration, threads] : log) {
    if (iteration <= before || threads < 1) return false;
    before = iteration;
  }
  return true;
}

}  // namespace physinv
