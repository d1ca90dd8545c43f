/// What a stage did, in units of one sample: calls made, and calls saved.
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
  skipped_events,    ///< motion that nobody observes, not simulated
  skipped_trials,    ///< line-search trials known to change nothing
  skipped_zeros,     ///< entries of y without a signal, not computed
  skipped_steps,     ///< time steps of diverged samples, not simulated
  kCount
};

inline constexpr std::size_t kCounters =
    static_cast<std::size_t>(Counter::kCount);

/// Names as they stand in the record.
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
    "skipped_steps"};

class Counts {
 public:
  std::uint64_t& operator[](Counter c) {
    return values_[static_cast<std::size_t>(c)];
  }
  std::uint64_t operator[](Counter c) const {
    return values_[static_cast<std::size_t>(c)];
  }
  Counts& operator+=(const Counts& other) {
    for (std::size_t i = 0; i < kCounters; ++i) values_[i] += other.values_[i];
    return *this;
  }
  bool operator==(const Counts&) const = default;

 private:
  std::array<std::uint64_t, kCounters> values_{};
};

}  // namespace physinv
