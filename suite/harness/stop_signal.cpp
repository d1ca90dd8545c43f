#include "suite/harness/stop_signal.h"

namespace physinv {
namespace {

volatile std::sig_atomic_t stop_signal_count = 0;

}  // namespace

StopSignalWatch::StopSignalWatch() {
  stop_signal_count = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { stop_signal_count = stop_signal_count + 1; };
  sigaction(SIGINT, &action, &old_int_);
  sigaction(SIGTERM, &action, &old_term_);
}

StopSignalWatch::~StopSignalWatch() {
  sigaction(SIGINT, &old_int_, nullptr);
  sigaction(SIGTERM, &old_term_, nullptr);
}

int stop_signals() { return stop_signal_count; }

}  // namespace physinv
