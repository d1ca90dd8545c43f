#include "suite/core/threads.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "suite/core/check.h"
#include "suite/core/clock.h"

namespace physinv {
namespace {

/// Seconds that a thread stays awake for at most: about what it takes to wake
/// one that sleeps.
constexpr double kLongest = 100e-6, kShortest = 1e-6;

/// Leaves the core to its other thread for a moment.
void pause() {
#ifdef __x86_64__
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("isb" ::: "memory");
#endif
}

/// Waits until a number changes: briefly awake, then asleep (a futex). Staying
/// awake is worth it where that is sooner than a wake-up, as between the steps
/// of a small network. On a shared core it only holds up the other threads,
/// also the one that is waited for. How long the last waits were decides.
class Waiting {
 public:
  template <class T>
  void until_not(const std::atomic<T>& number, T old) {
    const double begin = wall_now();
    do {
      for (int i = 0; i < 32; ++i) {
        if (number.load(std::memory_order_acquire) != old) return;
        pause();
      }
    } while (wall_now() - begin < awake_);
    number.wait(old, std::memory_order_acquire);
    const bool brief = wall_now() - begin < 2 * kLongest;
    awake_ = std::clamp(brief ? 2 * awake_ : awake_ / 2, kShortest, kLongest);
  }

 private:
  double awake_ = kLongest;  ///< seconds
};

}  // namespace

struct Threads::Pool {
  /// Set: no other worker enters; the bits below count the workers inside.
  static constexpr int kClosed = 1 << 30;

  std::vector<std::thread> workers;
  std::atomic<int> generation{0};  // one more for every run
  std::atomic<int> inside{kClosed};
  std::atomic<bool> stop{false};
  /// A thread's own blocks, in order: in the next run of as many blocks it has
  /// them again, and their data. Who has none left helps the others.
  struct alignas(64) Share {
    std::atomic<Index> next{0};
    Index end = 0;
  };

  std::vector<Share> shares;
  Call call = nullptr;
  void* body = nullptr;
  std::mutex mutex;
  std::exception_ptr error;
  Waiting waiting;  // of the thread that starts the work

  ~Pool() {
    stop = true;
    start_generation();
    for (std::thread& t : workers) t.join();
  }

  explicit Pool(int count) : shares(static_cast<std::size_t>(count)) {}

  void start(int count) {
    workers.reserve(static_cast<std::size_t>(count - 1));
    for (int t = 1; t < count; ++t)
      workers.emplace_back([this, t] { loop(t); });
  }

  void work(int thread) {
    const auto own = static_cast<std::size_t>(thread);
    for (std::size_t k = 0; k < shares.size(); ++k) {
      Share& share = shares[(own + k) % shares.size()];
      while (share.next.load(std::memory_order_relaxed) < share.end) {
        const Index b = share.next.fetch_add(1);
        if (b < share.end) work_on(b, thread);
      }
    }
  }

  void work_on(Index block, int thread) {
    try {
      call(body, block, thread);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!error) error = std::current_exception();
    }
  }

  void loop(int thread) {
    Waiting own;
    for (int seen = 0;;) {
      own.until_not(generation, seen);
      seen = generation.load();
      if (stop.load()) return;
      if (!enter()) continue;
      work(thread);
      if (inside.fetch_sub(1) - 1 == kClosed) inside.notify_one();
    }
  }

  /// A thread that comes too late is not waited for.
  bool enter() {
    int now = inside.load();
    while ((now & kClosed) == 0)
      if (inside.compare_exchange_weak(now, now + 1)) return true;
    return false;
  }

  void open(Index blocks) {
    const auto count = static_cast<Index>(shares.size());
    for (Index t = 0; t < count; ++t) {
      Share& share = shares[static_cast<std::size_t>(t)];
      share.next = blocks * t / count;
      share.end = blocks * (t + 1) / count;
    }
    inside = 0;
    start_generation();
  }

  void close() {
    int left = inside.fetch_or(kClosed) | kClosed;
    for (; left != kClosed; left = inside.load())
      waiting.until_not(inside, left);
  }

  void start_generation() {
    generation.fetch_add(1);
    generation.notify_all();
  }
};

Threads::Threads(int count) : count_(count) {
  SUITE_CHECK(count >= 1, "the number of threads must be at least 1");
  if (count == 1) return;
  pool_ = std::make_unique<Pool>(count);
  try {
    pool_->start(count);
  } catch (const std::system_error& error) {
    throw std::system_error(
        error.code(),
        fmt::format("only {} of {} threads could be started",
                    pool_->workers.size() + 1,
                    count));
  }
}

Threads::~Threads() = default;

void Threads::run(Index blocks, Call call, void* body) {
  if (!pool_) {
    for (Index b = 0; b < blocks; ++b) call(body, b, 0);
    return;
  }
  Pool& p = *pool_;
  p.call = call, p.body = body, p.error = nullptr;
  p.open(blocks);
  p.work(0);
  p.close();
  if (p.error) std::rethrow_exception(p.error);
}

}  // namespace physinv
