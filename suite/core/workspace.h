/// Scratch memory and tapes: everything a kernel needs in addition to its
/// arguments. Both settle within the first call of a size and allocate nothing
/// afterwards.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/buffer.h"
#include "suite/core/check.h"
#include "suite/core/counts.h"

namespace physinv {

class Threads;

template <class T>
using Scratch = Eigen::Map<Batch<T>, Eigen::Aligned64>;

/// Stack of scratch arrays. Take arrays inside a `Scope`; they are given back
/// when it ends. Not shared between threads: `of_thread(i)` is thread i's own.
class Workspace {
 public:
  explicit Workspace(Threads* threads = nullptr);
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;
  ~Workspace();

  class Scope {
   public:
    explicit Scope(Workspace& w)
        : work_(w), chunk_(w.chunk_), used_(w.used_), taken_(w.taken_) {}
    ~Scope() {
      work_.chunk_ = chunk_, work_.used_ = used_, work_.taken_ = taken_;
      if (taken_ == 0 && work_.chunks_.size() > 1) work_.gather();
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Workspace& work_;
    std::size_t chunk_, used_, taken_;
  };

  /// Uninitialised rows x cols array, valid until the enclosing scope ends.
  template <class T>
  Scratch<T> take(Index rows, Index cols) {
    const auto count = static_cast<std::size_t>(rows * cols);
    return {static_cast<T*>(allocate(count * sizeof(T))), rows, cols};
  }

  /// Bytes held, its threads' workspaces included.
  std::size_t bytes() const;

  Threads* threads() const { return threads_; }
  Workspace& of_thread(int thread);

  Counts counts;  ///< work done and saved by kernels using this workspace

 private:
  void* allocate(std::size_t bytes);
  /// One chunk of what was needed at most, once nothing is in use.
  void gather();

  std::vector<Buffer> chunks_;
  std::size_t chunk_ = 0, used_ = 0;
  std::size_t taken_ = 0, most_ = 0;  ///< bytes in use, now and ever
  Threads* threads_;
  std::vector<std::unique_ptr<Workspace>> per_thread_;
};

/// What a forward pass remembers for its pullback: numbered arrays whose
/// memory is kept from call to call. The writer defines what a slot means.
class Tape {
 public:
  explicit Tape(Threads* threads = nullptr);
  Tape(Tape&&) noexcept;
  Tape& operator=(Tape&&) noexcept;
  ~Tape();

  Threads* threads() const { return threads_; }

  /// Opens slot i for writing; old contents are lost if the size changed.
  template <class T>
  Scratch<T> slot(std::size_t i, Index rows, Index cols) {
    return {static_cast<T*>(open(i, rows, cols, sizeof(T))), rows, cols};
  }

  /// Reads slot i, which must have been opened with the same T.
  template <class T>
  Scratch<T> view(std::size_t i) const {
    SUITE_CHECK(i < slots_.size(), "tape slot was never written");
    const Slot& s = slots_[i];
    return {static_cast<T*>(s.buffer.data()), s.rows, s.cols};
  }

  std::size_t bytes() const;

  Counts counts;

 private:
  struct Slot {
    Buffer buffer;
    Index rows = 0, cols = 0;
  };
  void* open(std::size_t i, Index rows, Index cols, std::size_t bytes);

  std::vector<Slot> slots_;
  Threads* threads_;
};

}  // namespace physinv
