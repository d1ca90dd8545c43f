/// Which running cases take over cores that a campaign has free near its end.
#pragma once

#include <limits>
#include <map>
#include <vector>

namespace physinv {

/// By worker. Free cores are given one by one to the case that has most work
/// left per thread.
class CoreShares {
 public:
  /// A case runs for `least_seconds` before it is asked to leave its worker, as
  /// leaving takes time.
  CoreShares(int cores, double least_seconds)
      : cores_(cores), least_seconds_(least_seconds) {}

  /// It has a case, in so many threads.
  void submitted(std::size_t worker, int threads) {
    cases_[worker] = {.threads = threads};
  }
  /// It runs a stage at the time `now` [s]. Otherwise it keeps its threads.
  void started(std::size_t worker, double now);
  void ended(std::size_t worker) { cases_.erase(worker); }
  /// In operations, of the case that it runs.
  void set_work_left(std::size_t worker, double work) {
    cases_[worker].work = work;
  }

  /// Cases that should be left and resumed with more threads; each once.
  std::vector<std::size_t> to_ask(double now);
  /// For a case that was left.
  int threads_for(std::size_t worker, double now) const;

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  struct Running {
    int threads = 0;
    double work = 0, since = kNever, asked = kNever;
  };
  /// Threads of all workers once the free cores are given away; `left` is the
  /// one whose case was left.
  std::map<std::size_t, int> shares(double now, std::size_t left) const;

  int cores_;
  double least_seconds_;
  std::map<std::size_t, Running> cases_;
};

}  // namespace physinv
