/// What a stage did, in units of one sample: calls made, and calls saved; of
/// half-inverses, whose updates are of whole batches, in units of an update.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace physinv {

enum class Counter : std::uint8_t {
  forward,           ///< simulations
  vjp,               ///< simulations with a gradient (forward included)
  jacobian,          ///< full Jacobians and Hessians (forward included)
  inverse,           ///< local inverses
  network_forward,   ///< network passes forward
  network_backward,  ///< network passes backward
  skipped_vjp,       ///< gradients known to be zero, not computed
  skipped_forward,   ///< evaluations of finished examples, not made
  skipped_features,  ///< input encodings reused, not recomputed
  skipped_rows,      ///< first-layer rows folded, constant over the batch
  skipped_events,    ///< motion that does not affect the observation, not
                     ///< simulated
  skipped_trials,    ///< line-search trials known to change nothing
  skipped_zeros,     ///< entries of y without a signal, not computed
  skipped_steps,     ///< time steps of diverged samples, not simulated
  skipped_terms,   ///< terms of time steps, zero by their factor, not computed
  skipped_levels,  ///< more exact decompositions, shown not to be needed
  abandoned_levels,  ///< decompositions made and given up for another
  kCount
};

inline constexpr std::size_t kCounters =
    static_cast<std::size_t>(Counter::kCount);

/// Names as in the record.
inline constexpr std::array<std::string_view, kCounters> kCounterNames = {
    "forward",
    "vjp",
    "jacobian",
    "inverse",
    "network_forward",
    "network_backward",
    "skipped_vjp",
    "skipped_forward",
    "skipped_features",
    "skipped_rows",
    "skipped_events",
    "skipped_trials",
    "skipped_zeros",
    "skipped_steps",
    "skipped_terms",
    "skipped_levels",
    "abandoned_levels"};

/// What is counted, as a page says it.
inline constexpr std::array<std::string_view, kCounters> kCounterWords = {
    "simulations",
    "gradients",
    "Jacobians",
    "inverses",
    "network passes forward",
    "network passes backward",
    "gradients known to be zero",
    "evaluations of finished examples",
    "encodings of inputs",
    "constant rows of a first layer",
    "motions that nobody observes",
    "trials of line searches that change nothing",
    "entries of y without a signal",
    "time steps of diverged samples",
    "terms of time steps that are zero",
    "more exact decompositions of half-inverses",
    "decompositions of half-inverses"};

class Counts {
 public:
  std::uint64_t& operator[](Counter c) {
    return values_[static_cast<std::size_t>(c)];
  }
  std::uint64_t operator[](Counter c) const {
    return values_[static_cast<std::size_t>(c)];
  }
  /// A record that is older than this counter does not have it.
  void forget(Counter c) { forgotten_ |= bit(c); }
  bool knows(Counter c) const { return (forgotten_ & bit(c)) == 0; }

  /// What one of them does not have, the sum does not.
  Counts& operator+=(const Counts& other) {
    for (std::size_t i = 0; i < kCounters; ++i) values_[i] += other.values_[i];
    forgotten_ |= other.forgotten_;
    return *this;
  }
  bool operator==(const Counts&) const = default;

 private:
  static std::uint64_t bit(Counter c) {
    return std::uint64_t{1} << static_cast<std::size_t>(c);
  }

  std::array<std::uint64_t, kCounters> values_{};
  std::uint64_t forgotten_ = 0;
};

}  // namespace physinv
