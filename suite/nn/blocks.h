/// Blocks of work, each with scratch of its own.
#pragma once

#include "suite/core/threads.h"
#include "suite/core/workspace.h"

namespace physinv::nn {

/// body(block, workspace) for every block; what it takes is given back after
/// each. The workspace has no threads, or is the only one.
template <class F>
void each_block(Workspace& work, Index blocks, F&& body) {
  Threads* const threads = work.threads();
  const bool threaded = threads != nullptr && threads->count() > 1;
  if (threaded) work.of_thread(0);  // makes all of them, before they run
  physinv::for_blocks(threads, blocks, [&](Index block, int thread) {
    Workspace& own = threaded ? work.of_thread(thread) : work;
    const Workspace::Scope scope(own);
    body(block, own);
  });
}

}  // namespace physinv::nn
