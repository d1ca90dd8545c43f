#include "suite/core/buffer.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstdlib>
#include <new>

namespace physinv {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;

/// On huge pages where there is room for some: fewer faults, fewer misses of
/// the address cache. A system without them ignores the advice.
void* allocate_pages(std::size_t bytes) {
  if (bytes < 2 * kHugePage) return std::aligned_alloc(kAlignment, bytes);
  const std::size_t whole = (bytes + kHugePage - 1) / kHugePage * kHugePage;
  void* p = std::aligned_alloc(kHugePage, whole);
  if (p != nullptr) ::madvise(p, whole, MADV_HUGEPAGE);
  return p;
}

}  // namespace

void Buffer::Free::operator()(void* p) const { std::free(p); }

void* Buffer::reserve(std::size_t bytes) {
  if (bytes > bytes_ || !data_) {
    const std::size_t size = std::max(aligned_size(bytes), kAlignment);
    data_.reset();
    bytes_ = 0;
    data_.reset(allocate_pages(size));
    if (!data_) throw std::bad_alloc();
    bytes_ = size;
  }
  return data_.get();
}

}  // namespace physinv
