/// Wall and CPU time of this process.
#pragma once

#include <ctime>

namespace physinv {

struct Seconds {
  double wall = 0, cpu = 0;
  Seconds& operator+=(Seconds other) {
    wall += other.wall, cpu += other.cpu;
    return *this;
  }
  friend Seconds operator-(Seconds a, Seconds b) {
    return {a.wall - b.wall, a.cpu - b.cpu};
  }
};

inline double seconds_of(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Monotonic wall time, without the system call that CPU time takes.
inline double wall_now() { return seconds_of(CLOCK_MONOTONIC); }

/// Monotonic wall time and the CPU time of all threads.
inline Seconds now() {
  return {wall_now(), seconds_of(CLOCK_PROCESS_CPUTIME_ID)};
}

/// Clocks of a stage. Setup and warm-up are apart from solving; so is drawing
/// training examples while it solves. Measuring is the time spent on curves, in
/// none of the others.
struct Clocks {
  Seconds setup, warmup, data, solve, measure;

  Seconds total() const {
    Seconds sum = setup;
    return (((sum += warmup) += data) += solve) += measure;
  }
};

}  // namespace physinv
