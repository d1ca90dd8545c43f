/// SIGINT and SIGTERM as a wish to end.
#pragma once

#include <csignal>

namespace physinv {

/// While it lives, the two only count and end waits. There is one at a time.
class StopSignalWatch {
 public:
  StopSignalWatch();
  ~StopSignalWatch();
  StopSignalWatch(const StopSignalWatch&) = delete;
  StopSignalWatch& operator=(const StopSignalWatch&) = delete;

 private:
  struct sigaction old_int_ {
  }, old_term_{};
};

/// How many came since the last watch began.
int stop_signals();

}  // namespace physinv
