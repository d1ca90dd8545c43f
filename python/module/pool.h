/// Scratch that calls of any thread take and give back: what kernels need keeps
/// its memory from call to call.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace physinv::python {

template <class S>
class Pool {
 public:
  class Lease {
   public:
    Lease(Pool& pool, std::unique_ptr<S> item)
        : pool_(&pool), item_(std::move(item)) {}
    Lease(Lease&&) noexcept = default;
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    Lease& operator=(Lease&&) = delete;
    ~Lease() {
      if (item_) pool_->give(std::move(item_));
    }
    S& operator*() const { return *item_; }

   private:
    Pool* pool_;
    std::unique_ptr<S> item_;
  };

  Lease take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return {*this, std::make_unique<S>()};
    auto item = std::move(free_.back());
    free_.pop_back();
    return {*this, std::move(item)};
  }

 private:
  void give(std::unique_ptr<S> item) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(item));
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<S>> free_;
};

}  // namespace physinv::python
