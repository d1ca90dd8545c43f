#include "suite/planning/forecast.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>

#include "suite/core/clock.h"
#include "suite/harness/progress.h"
#include "suite/planning/kinds.h"
#include "suite/planning/operation_rates.h"
#include "suite/planning/split.h"
#include "suite/planning/trials.h"
#include "suite/store/errors.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

/// A directory that goes with the object.
class PassingDirectory {
 public:
  PassingDirectory() {
    std::string name =
        (fs::temp_directory_path() / "physinv-speeds-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~PassingDirectory() {
    std::error_code none;
    if (!path_.empty()) fs::remove_all(path_, none);
  }
  PassingDirectory(const PassingDirectory&) = delete;
  PassingDirectory& operator=(const PassingDirectory&) = delete;
  fs::path file() const { return path_ / "physinv" / "speeds.json"; }

 private:
  fs::path path_;
};

/// By the work that is tried, least first.
std::vector<const Sizes*> cheapest_first(const Kinds& kinds) {
  std::map<const Sizes*, double> work;
  std::vector<const Sizes*> order;
  for (const auto& [kind, sizes] : kinds) {
    order.push_back(&sizes);
    const Case& c = *sizes.largest;
    const auto most =
        *std::max_element(c.stage_iterations.begin(), c.stage_iterations.end());
    work[&sizes] =
        c.operations() / static_cast<double>(std::max<Index>(1, most));
  }
  std::stable_sort(order.begin(), order.end(), [&](auto* a, auto* b) {
    return work[a] < work[b];
  });
  return order;
}

/// Of each experiment the kind with most work.
std::vector<const Sizes*> one_each(const Kinds& kinds) {
  std::map<std::string, std::pair<double, const Sizes*>> most;
  for (const auto& [kind, sizes] : kinds) {
    auto& found = most[sizes.largest->info.experiment];
    const double work = sizes.largest->operations();
    if (found.second == nullptr || work > found.first) found = {work, &sizes};
  }
  std::vector<const Sizes*> each;
  for (const auto& [name, found] : most) each.push_back(found.second);
  return each;
}

/// In the child: whatever a method does there, it does to this process alone.
[[noreturn]] void measure(const Kinds& kinds, const fs::path& cache) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    dup2(nowhere, fd);
  try {
    Trials trials(cache);
    for (const Sizes* sizes : one_each(kinds)) {
      trials.of(brief_case(*sizes), true);
      trials.save();
    }
    for (const Sizes* sizes : cheapest_first(kinds)) {
      const std::size_t ran = trials.ran();
      trials_of(*sizes, trials);
      if (trials.ran() > ran) trials.save();
    }
  } catch (...) {
  }
  _exit(0);
}

/// Until the process ends, or the time.
void wait_for(pid_t child, double seconds) {
  constexpr int kMilliseconds = 5;
  const double end = now().wall + seconds;
  while (waitpid(child, nullptr, WNOHANG) == 0) {
    if (now().wall >= end) {
      kill(child, SIGKILL);
      while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
      }
      return;
    }
    poll(nullptr, 0, kMilliseconds);
  }
}

/// By what is known; a stage's share of the time is then not known.
Forecast by_known(const std::vector<Case>& cases,
                  const Kinds& kinds,
                  const Trials& trials) {
  Forecast f{.costs = {}, .chains = kinds.size()};
  std::map<Kind, std::vector<Trial>> known;
  for (const auto& [kind, sizes] : kinds) {
    auto found = known_trials(sizes, trials);
    if (!found.empty()) known[kind] = std::move(found);
  }
  f.measured = known.size();
  Operations operations;
  OperationRates rates;
  for (const Case& c : cases) {
    const auto at = known.find(kind_of(c));
    if (at == known.end()) {
      f.costs.push_back(unmeasured_cost(c));
      continue;
    }
    f.costs.push_back(cost_of(c, at->second));
    rates.add(c.info.experiment, {operations.of(c), f.costs.back().seconds});
  }
  for (const Sizes* sizes : one_each(kinds)) {
    const Case brief = brief_case(*sizes);
    if (const Trial* trial = trials.known(brief, true))
      rates.add(brief.info.experiment, work_of(brief, *trial));
  }
  for (std::size_t i = 0; i < cases.size(); ++i)
    if (!known.contains(kind_of(cases[i])))
      f.costs[i].seconds =
          rates.seconds(cases[i].info.experiment, operations.of(cases[i]));
  return f;
}

}  // namespace

Forecast forecast(const std::vector<Case>& cases,
                  double seconds,
                  const fs::path& cache) {
  const Kinds kinds = kinds_of(cases);
  Forecast soon = by_known(cases, kinds, Trials(cache));
  if (soon.measured == soon.chains || !(seconds > 0)) return soon;
  const PassingDirectory passing;
  const fs::path file = cache.empty() ? passing.file() : cache;
  const pid_t child = fork();
  if (child < 0) return soon;
  if (child == 0) measure(kinds, file);
  wait_for(child, seconds);
  return by_known(cases, kinds, Trials(file));
}

std::string about_text(const std::vector<Case>& cases,
                       int workers,
                       bool watched) {
  constexpr double kLittle = 1e10, kSeconds = 1;
  Operations operations;
  double sum = 0;
  for (const Case& c : cases) sum += operations.of(c);
  if (sum < kLittle) return "";
  try {
    const Forecast f =
        forecast(cases, watched ? kSeconds : 0, Trials::default_file());
    const double seconds = seconds_with(f.costs, workers);
    return seconds >= 0 ? ", about " + duration_text(seconds) : "";
  } catch (const StoreError&) {  // a cache that is none; plan says so
    return "";
  }
}

double seconds_with(const std::vector<Cost>& costs, int workers) {
  std::vector<double> seconds;
  for (const Cost& c : costs) {
    if (!std::isfinite(c.seconds)) return c.seconds;
    seconds.push_back(c.seconds);
  }
  return split_longest_first(seconds, static_cast<std::size_t>(workers))
      .longest;
}

}  // namespace physinv
