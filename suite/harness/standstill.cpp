#include "suite/harness/standstill.h"

#include <ctime>

namespace physinv {

Standstill::Last& Standstill::at(std::size_t w) {
  if (last_.size() <= w) last_.resize(w + 1);
  return last_[w];
}

void Standstill::moved(std::size_t w, double now) {
  at(w) = {.watched = true, .now = now, .asked = now};
}

void Standstill::idle(std::size_t w) { at(w) = {}; }

bool Standstill::found(std::size_t w, double now, double cpu) {
  constexpr double kComputing = 0.01, kStopped = 5;
  Last& last = at(w);
  if (!last.watched || last.named) return false;
  const bool stopped = now - last.asked > kStopped;  // we were, so it may be
  last.asked = now;
  if (!last.begun || stopped || cpu - last.cpu > kComputing * seconds_) {
    last.begun = true, last.now = now, last.cpu = cpu;
    return false;
  }
  last.named = now - last.now >= seconds_;
  return last.named;
}

double cpu_seconds(int process) {
  if (process <= 0) return 0;
  clockid_t clock{};
  timespec spent{};
  if (clock_getcpuclockid(process, &clock) != 0 ||
      clock_gettime(clock, &spent) != 0)
    return 0;
  return static_cast<double>(spent.tv_sec) +
         1e-9 * static_cast<double>(spent.tv_nsec);
}

}  // namespace physinv
