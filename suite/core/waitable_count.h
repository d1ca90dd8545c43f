/// A count of finished parts that another thread can wait for.
/// It must have started before anyone waits for it.
#pragma once

#include <atomic>
#include <thread>

#include "suite/core/batch.h"

namespace physinv {

class alignas(64) WaitableCount {
 public:
  void reach(Index count) { count_.store(count, std::memory_order_release); }
  void wait_for(Index count) const {
    constexpr int kAwake = 256;  // then others may need the core
    for (int tries = 0; count_.load(std::memory_order_acquire) < count;)
      if (++tries > kAwake) std::this_thread::yield();
  }

 private:
  std::atomic<Index> count_{0};
};

}  // namespace physinv
