#include "suite/core/workspace.h"

#include <algorithm>

#include "suite/core/threads.h"

namespace physinv {
namespace {

constexpr std::size_t kFirstChunk = std::size_t{64} << 10;

}  // namespace

Workspace::Workspace(Threads* threads) : threads_(threads) {}
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;
Workspace::~Workspace() = default;

void* Workspace::allocate(std::size_t bytes) {
  const std::size_t size = aligned_size(bytes);
  while (chunk_ < chunks_.size() && used_ + size > chunks_[chunk_].bytes())
    ++chunk_, used_ = 0;
  if (chunk_ == chunks_.size()) {
    const std::size_t last = chunks_.empty() ? 0 : chunks_.back().bytes();
    chunks_.emplace_back().reserve(std::max({size, 2 * last, kFirstChunk}));
    used_ = 0;
  }
  void* p = static_cast<std::byte*>(chunks_[chunk_].data()) + used_;
  used_ += size;
  taken_ += size;
  most_ = std::max(most_, taken_);
  return p;
}

void Workspace::gather() {
  chunks_.clear();
  chunks_.emplace_back().reserve(most_);
}

std::size_t Workspace::bytes() const {
  std::size_t sum = 0;
  for (const Buffer& chunk : chunks_) sum += chunk.bytes();
  for (const auto& w : per_thread_) sum += w->bytes();
  return sum;
}

Workspace& Workspace::of_thread(int thread) {
  const auto i = static_cast<std::size_t>(thread);
  SUITE_CHECK(i < per_thread_.size() || threads_ != nullptr,
              "thread workspaces need a workspace with threads");
  if (per_thread_.empty()) {
    per_thread_.resize(static_cast<std::size_t>(threads_->count()));
    for (auto& w : per_thread_) w = std::make_unique<Workspace>();
  }
  return *per_thread_[i];
}

Tape::Tape(Threads* threads) : threads_(threads) {}
Tape::Tape(Tape&&) noexcept = default;
Tape& Tape::operator=(Tape&&) noexcept = default;
Tape::~Tape() = default;

void* Tape::open(std::size_t i, Index rows, Index cols, std::size_t bytes) {
  if (i >= slots_.size()) slots_.resize(i + 1);
  Slot& s = slots_[i];
  s.rows = rows, s.cols = cols;
  return s.buffer.reserve(static_cast<std::size_t>(rows * cols) * bytes);
}

std::size_t Tape::bytes() const {
  std::size_t sum = 0;
  for (const Slot& slot : slots_) sum += slot.buffer.bytes();
  return sum;
}

}  // namespace physinv
