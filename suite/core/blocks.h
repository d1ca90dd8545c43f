/// Blocks of work with scratch of their own, and samples of a batch a register
/// at a time.
#pragma once

#include <algorithm>

#include "suite/core/threads.h"
#include "suite/core/workspace.h"

namespace physinv {

inline Index count_of(const Threads* threads) {
  return threads != nullptr ? threads->count() : 1;
}

/// body(block, workspace) for every block; what it takes is given back after
/// each. The workspace has no threads, or is the only one.
template <class F>
void for_blocks(Workspace& work, Index blocks, F&& body) {
  const bool threaded = count_of(work.threads()) > 1;
  if (threaded) work.of_thread(0);  // makes all of them, before they run
  for_blocks(work.threads(), blocks, [&](Index block, int thread) {
    Workspace& own = threaded ? work.of_thread(thread) : work;
    const Workspace::Scope scope(own);
    body(block, own);
  });
}

/// Samples first .. first+count-1, one per lane; the last one fills what is
/// left of a register.
struct SampleBlock {
  Index first, count;

  Index column(Index lane) const { return first + std::min(lane, count - 1); }
};

constexpr Index registers(Index samples, Index lanes) {
  return (samples + lanes - 1) / lanes;
}

/// f(block, thread), or f(block, workspace), for every register of samples:
/// `work` is Threads* or a Workspace.
template <class Work, class F>
void for_registers(Work&& work, Index samples, Index lanes, F&& f) {
  for_blocks(work, registers(samples, lanes), [&](Index block, auto&& own) {
    const Index first = block * lanes;
    f(SampleBlock{first, std::min(lanes, samples - first)}, own);
  });
}

}  // namespace physinv
