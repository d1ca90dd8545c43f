/// Memory for kernels.
#pragma once

#include <cstddef>
#include <memory>

namespace physinv {

inline constexpr std::size_t kAlignment = 64;

/// Up to the end of its last 64 bytes.
constexpr std::size_t aligned_size(std::size_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

/// A 64-byte aligned block that only ever grows.
class Buffer {
 public:
  /// At least `bytes` of memory; contents are undefined after growing.
  void* reserve(std::size_t bytes);
  void* data() const { return data_.get(); }
  std::size_t bytes() const { return bytes_; }

 private:
  struct Free {
    void operator()(void* p) const;
  };
  std::unique_ptr<void, Free> data_;
  std::size_t bytes_ = 0;
};

}  // namespace physinv
