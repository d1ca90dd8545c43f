#include "suite/harness/core_shares.h"

#include <algorithm>

namespace physinv {
namespace {

/// Seconds after which a case that was asked is taken for one that does not
/// save its state; the others get its share.
constexpr double kPatienceOfAsked = 20;

constexpr auto kNoWorker = std::numeric_limits<std::size_t>::max();

}  // namespace

void CoreShares::started(std::size_t worker, double now) {
  double& since = cases_[worker].since;
  since = std::min(since, now);
}

std::map<std::size_t, int> CoreShares::shares(double now,
                                              std::size_t left) const {
  std::map<std::size_t, int> threads;
  int used = 0;
  for (const auto& [worker, c] : cases_) used += threads[worker] = c.threads;
  const auto takes_more = [&](const auto& running) {
    const Running& c = running.second;
    return running.first == left ||
           (c.since != kNever && now - c.asked < kPatienceOfAsked);
  };
  for (; used < cores_; ++used) {
    int* neediest = nullptr;
    double most = -1;
    for (const auto& running : cases_) {
      int& own = threads[running.first];
      const double work = running.second.work / own;
      if (takes_more(running) && work > most) most = work, neediest = &own;
    }
    if (neediest == nullptr) break;
    ++*neediest;
  }
  return threads;
}

std::vector<std::size_t> CoreShares::to_ask(double now) {
  std::vector<std::size_t> asked;
  for (const auto& [worker, threads] : shares(now, kNoWorker)) {
    Running& c = cases_[worker];
    const bool has_run = now - c.since >= least_seconds_;
    if (threads == c.threads || c.asked != kNever || !has_run) continue;
    c.asked = now;
    asked.push_back(worker);
  }
  return asked;
}

int CoreShares::threads_for(std::size_t worker, double now) const {
  return shares(now, worker).at(worker);
}

}  // namespace physinv
