/// Counter-based random streams, addressed by name: Philox4x64-10 of Random123
/// (Salmon et al. 2011) under our own hash and distributions, because those of
/// the standard library differ between implementations.
///
///   Rng root = Rng::root("jpo/billiards", seed);
///   Stream s = root.child("data/test").child(i).stream();
///   double h = s.uniform(0.0, 1.0);
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "suite/core/batch.h"

namespace physinv {

/// Numbers of one stream, in order.
class Stream {
 public:
  explicit Stream(std::uint64_t key) : key_(key) {}

  std::uint64_t bits();
  /// Uniform in [0, 1), 53 random bits.
  double uniform();
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  /// Standard normal (Box-Muller, one of the pair kept for the next call).
  double normal();
  /// The next `count` of them: the same numbers, some at once.
  void normals(double* to, Index count);

 private:
  std::uint64_t key_, counter_ = 0;
  std::array<std::uint64_t, 4> block_{};
  int left_ = 0;
  double spare_ = 0;
  bool has_spare_ = false;
};

/// A place in the tree of streams. Children are independent of each other and
/// of the order in which they are asked for.
class Rng {
 public:
  static Rng root(std::string_view experiment, std::uint64_t seed);
  Rng child(std::string_view name) const;
  Rng child(std::uint64_t i) const;
  Stream stream() const { return Stream(key_); }

 private:
  explicit Rng(std::uint64_t key) : key_(key) {}
  std::uint64_t key_;
};

}  // namespace physinv
