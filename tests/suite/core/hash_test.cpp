#include "suite/core/hash.h"

#include <gtest/gtest.h>

#include <set>

namespace physinv {
namespace {

// The first numbers of SplitMix64 from seed 0.
TEST(Mix64, KnownAnswers) {
  EXPECT_EQ(mix64(0), 0U);
  EXPECT_EQ(mix64(0x9e3779b97f4a7c15ULL), 0xe220a8397b1dcdafULL);
  EXPECT_EQ(mix64(2 * 0x9e3779b97f4a7c15ULL), 0x6e789e6aa1b965f4ULL);
}

// FNV-1a of "" and "foobar" (from its authors), mixed with the length.
TEST(HashBytes, KnownAnswers) {
  EXPECT_EQ(hash_text(""), mix64(0xcbf29ce484222325ULL));
  EXPECT_EQ(hash_text("foobar"), mix64(0x85944171f73967e8ULL ^ 6));
}

TEST(HashBytes, ChainsAndSeparates) {
  EXPECT_EQ(hash_text("ab"), hash_bytes("ab", 2));
  EXPECT_NE(hash_text("b", hash_text("a")), hash_text("ab"));
  EXPECT_NE(hash_text("b", hash_text("a")), hash_text("a", hash_text("b")));
  std::set<std::uint64_t> all;
  std::string text(40, '\0');
  for (std::size_t length = 0; length <= text.size(); ++length)
    all.insert(hash_bytes(text.data(), length));
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string flipped = text;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << bit));
      all.insert(hash_text(flipped));
    }
  }
  EXPECT_EQ(all.size(), 41 + 40 * 8U);
}

TEST(Hex64, HasSixteenDigits) {
  EXPECT_EQ(hex64(0), "0000000000000000");
  EXPECT_EQ(hex64(0xabcULL), "0000000000000abc");
  EXPECT_EQ(hex64(~0ULL), "ffffffffffffffff");
}

}  // namespace
}  // namespace physinv
