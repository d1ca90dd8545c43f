/// Stable 64-bit hashes: names of random streams, content keys, trajectories.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace physinv {

/// Finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection that mixes.
constexpr std::uint64_t mix64(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// FNV-1a over bytes, then mixed. Not cryptographic.
std::uint64_t hash_bytes(const void* data,
                         std::size_t bytes,
                         std::uint64_t seed = 0xcbf29ce484222325ULL);

inline std::uint64_t hash_text(std::string_view text,
                               std::uint64_t seed = 0xcbf29ce484222325ULL) {
  return hash_bytes(text.data(), text.size(), seed);
}

/// 16 lower-case hexadecimal digits.
std::string hex64(std::uint64_t value);

/// Two hashes of a text as 32 digits.
std::string hex128(std::string_view text);

}  // namespace physinv
