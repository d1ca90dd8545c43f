#include "suite/core/threads.h"

#include <fmt/format.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "suite/core/check.h"

namespace physinv {
namespace {

/// Rounds of spinning before a waiting thread sleeps: a step of a small
/// network is shorter than a wake-up.
constexpr int kSpins = 20000;

}  // namespace

struct Threads::Pool {
  std::vector<std::thread> workers;
  std::mutex mutex;
  std::condition_variable wake;
  std::atomic<std::uint64_t> generation{0};
  std::atomic<bool> stop{false};
  std::atomic<Index> next{0};
  std::atomic<int> running{0};
  Index blocks = 0;
  Call call = nullptr;
  void* body = nullptr;
  std::exception_ptr error;

  ~Pool() {
    stop = true;
    start_generation();
    for (std::thread& t : workers) t.join();
  }

  void start(int count) {
    workers.reserve(static_cast<std::size_t>(count - 1));
    for (int t = 1; t < count; ++t)
      workers.emplace_back([this, t] { loop(t); });
  }

  void work(int thread) {
    for (Index b; (b = next.fetch_add(1)) < blocks;) {
      try {
        call(body, b, thread);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
      }
    }
  }

  void loop(int thread) {
    for (std::uint64_t seen = 0;;) {
      for (int i = 0; i < kSpins && generation.load() == seen; ++i) {
        __builtin_ia32_pause();
      }
      if (generation.load() == seen) {
        std::unique_lock lock(mutex);
        wake.wait(lock, [&] { return generation.load() != seen; });
      }
      seen = generation.load();
      if (stop.load()) return;
      work(thread);
      running.fetch_sub(1);
    }
  }

  void start_generation() {
    {
      const std::lock_guard lock(mutex);
      generation.fetch_add(1);
    }
    wake.notify_all();
  }
};

Threads::Threads(int count) : count_(count) {
  SUITE_CHECK(count >= 1, "a thread count is at least 1");
  if (count == 1) return;
  pool_ = std::make_unique<Pool>();
  try {
    pool_->start(count);
  } catch (const std::system_error& error) {
    throw std::system_error(
        error.code(),
        fmt::format(
            "{} of {} threads start", pool_->workers.size() + 1, count));
  }
}

Threads::~Threads() = default;

void Threads::run(Index blocks, Call call, void* body) {
  if (!pool_) {
    for (Index b = 0; b < blocks; ++b) call(body, b, 0);
    return;
  }
  Pool& p = *pool_;
  p.blocks = blocks, p.call = call, p.body = body, p.error = nullptr;
  p.next = 0;
  p.running = count_ - 1;
  p.start_generation();
  p.work(0);
  while (p.running.load() > 0) __builtin_ia32_pause();
  if (p.error) std::rethrow_exception(p.error);
}

}  // namespace physinv
