#include "suite/core/hash.h"

#include <fmt/format.h>

namespace physinv {

std::uint64_t hash_bytes(const void* data,
                         std::size_t bytes,
                         std::uint64_t seed) {
  const auto* p = static_cast<const unsigned char*>(data);
  std::uint64_t h = seed;
  for (std::size_t i = 0; i < bytes; ++i) {
    h = (h ^ p[i]) * 0x100000001b3ULL;
  }
  return mix64(h ^ bytes);
}

std::string hex64(std::uint64_t value) { return fmt::format("{:016x}", value); }

std::string hex128(std::string_view text) {
  return hex64(hash_text(text)) +
         hex64(hash_text(text, mix64(0x9e3779b97f4a7c15ULL)));
}

}  // namespace physinv
