/// Checksums of lines and files, and hashes of arrays.
#pragma once

#include <cstdint>
#include <string_view>

#include "suite/core/batch.h"
#include "suite/core/hash.h"

namespace physinv {

/// CRC-32C (Castagnoli): finds every burst of up to 32 wrong bits.
std::uint32_t crc32c(std::string_view bytes);

/// Hash of shapes and bits, a word at a time.
class ArrayHash {
 public:
  ArrayHash& add(std::uint64_t word) {
    state_ = mix64(state_ ^ word) + 0x9e3779b97f4a7c15ULL;
    return *this;
  }
  ArrayHash& add(const double* data, Index rows, Index cols);
  ArrayHash& add(const Batch<double>& b) {
    return add(b.data(), b.rows(), b.cols());
  }
  ArrayHash& add(std::string_view text) { return add(hash_text(text)); }
  std::uint64_t value() const { return mix64(state_); }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace physinv
