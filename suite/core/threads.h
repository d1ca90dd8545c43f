/// Threads over independent blocks. The caller cuts the work into blocks
/// whose number never depends on the thread count, so neither do the bits.
#pragma once

#include <memory>
#include <type_traits>

#include "suite/core/batch.h"

namespace physinv {

class Threads {
 public:
  /// `count` >= 1 threads, the calling one included. Throws std::system_error
  /// if they cannot all start, and leaves none behind.
  explicit Threads(int count = 1);
  ~Threads();
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  int count() const { return count_; }

  /// Calls body(block, thread) once for every block; returns when all are
  /// done. The first exception of a block is rethrown here.
  template <class F>
  void run(Index blocks, F&& body) {
    using Body = std::remove_reference_t<F>;
    run(
        blocks,
        [](void* f, Index block, int thread) {
          (*static_cast<Body*>(f))(block, thread);
        },
        const_cast<void*>(static_cast<const void*>(&body)));
  }

 private:
  using Call = void (*)(void* body, Index block, int thread);
  void run(Index blocks, Call call, void* body);

  struct Pool;
  int count_;
  std::unique_ptr<Pool> pool_;
};

/// The same loop where threads are optional.
template <class F>
void for_blocks(Threads* threads, Index blocks, F&& body) {
  if (threads != nullptr && threads->count() > 1 && blocks > 1) {
    threads->run(blocks, body);
  } else {
    for (Index b = 0; b < blocks; ++b) body(b, 0);
  }
}

}  // namespace physinv
