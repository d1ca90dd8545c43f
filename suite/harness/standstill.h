/// Which workers stand still: they have a case, report nothing of it and
/// compute nothing, as when they wait for a lock whose owner is gone.
#pragma once

#include <cstddef>
#include <vector>

namespace physinv {

class Standstill {
 public:
  /// Computing is more than one hundredth of the time on a core.
  explicit Standstill(double seconds) : seconds_(seconds) {}

  /// Worker `w` reported something, or got a case, at the time `now` [s].
  void moved(std::size_t w, double now);
  /// It has no case.
  void idle(std::size_t w);
  /// Has it stood still for that long at `now`, with so many CPU seconds so
  /// far? True once, and again after it has moved.
  bool found(std::size_t w, double now, double cpu);

  double seconds() const { return seconds_; }

 private:
  struct Last {
    bool watched = false, begun = false, named = false;
    double now = 0, asked = 0, cpu = 0;
  };
  Last& at(std::size_t w);

  double seconds_;
  std::vector<Last> last_;
};

/// CPU seconds of a process and all its threads; 0 of one that is not there.
double cpu_seconds(int process);

}  // namespace physinv
