#include "suite/store/checksum.h"

#include <array>
#include <bit>
#include <cstring>

#ifdef __SSE4_2__
#include <nmmintrin.h>
#elif defined(__ARM_FEATURE_CRC32)
#include <arm_acle.h>
#endif

namespace physinv {
namespace {

#ifdef __SSE4_2__

std::uint32_t add_word(std::uint32_t r, std::uint64_t word) {
  return static_cast<std::uint32_t>(_mm_crc32_u64(r, word));
}
std::uint32_t add_byte(std::uint32_t r, unsigned char byte) {
  return _mm_crc32_u8(r, byte);
}

#elif defined(__ARM_FEATURE_CRC32)

std::uint32_t add_word(std::uint32_t r, std::uint64_t word) {
  return __crc32cd(r, word);
}
std::uint32_t add_byte(std::uint32_t r, unsigned char byte) {
  return __crc32cb(r, byte);
}

#else

using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

/// tables[k][b]: what byte b does to the remainder k bytes further on.
constexpr Tables make_tables() {
  Tables t{};
  for (std::uint32_t b = 0; b < 256; ++b) {
    std::uint32_t r = b;
    for (int i = 0; i < 8; ++i) r = (r >> 1) ^ ((r & 1) ? 0x82f63b78U : 0U);
    t[0][b] = r;
  }
  for (std::size_t k = 1; k < 8; ++k) {
    for (std::size_t b = 0; b < 256; ++b)
      t[k][b] = (t[k - 1][b] >> 8) ^ t[0][t[k - 1][b] & 0xff];
  }
  return t;
}

constexpr Tables kTables = make_tables();

std::uint32_t add_word(std::uint32_t r, std::uint64_t word) {
  word ^= r;
  r = 0;
  for (std::size_t k = 0; k < 8; ++k)
    r ^= kTables[7 - k][(word >> (8 * k)) & 0xff];
  return r;
}
std::uint32_t add_byte(std::uint32_t r, unsigned char byte) {
  return (r >> 8) ^ kTables[0][(r ^ byte) & 0xff];
}

#endif

}  // namespace

std::uint32_t crc32c(std::string_view bytes) {
  static_assert(std::endian::native == std::endian::little);
  std::uint32_t r = ~0U;
  const char* p = bytes.data();
  std::size_t n = bytes.size();
  for (; n >= 8; p += 8, n -= 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, p, 8);
    r = add_word(r, word);
  }
  for (; n > 0; ++p, --n) r = add_byte(r, static_cast<unsigned char>(*p));
  return ~r;
}

ArrayHash& ArrayHash::add(const double* data, Index rows, Index cols) {
  add(static_cast<std::uint64_t>(rows));
  add(static_cast<std::uint64_t>(cols));
  for (Index i = 0; i < rows * cols; ++i)
    add(std::bit_cast<std::uint64_t>(data[i]));
  return *this;
}

}  // namespace physinv
