/// The packets and the networks that the study of the SIP wave packet varies.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "suite/core/batch.h"

namespace physinv::packet_width {

/// exp(-d^2 / (2 sigma^2)): what the paper calls sigma = 20 may be sigma^2.
inline constexpr Index kVariances[] = {20, 40, 100, 400};

struct Net {
  bool norm, pool_last, uniform;
};
inline constexpr Net kNets[] = {{false, false, false},
                                {false, false, true},
                                {false, true, false},
                                {false, true, true},
                                {true, false, false},
                                {true, false, true},
                                {true, true, false},
                                {true, true, true}};

struct Choice {
  Index variance;
  Net net;

  double width() const { return std::sqrt(static_cast<double>(variance)); }
  /// The suite's own.
  bool is_ours() const {
    return variance == 400 && !net.norm && !net.pool_last && !net.uniform;
  }
  /// The study's experiments; a table of all is with the first one.
  std::string name() const {
    return fmt::format("studies/sip-wave-packet-v{}{}{}{}",
                       variance,
                       net.norm ? "-norm" : "",
                       net.pool_last ? "-last" : "",
                       net.uniform ? "-uniform" : "");
  }
  std::string title() const {
    return fmt::format("{}, {}, pooling {}, {}{}",
                       variance,
                       net.norm ? "batch norm" : "no norm",
                       net.pool_last ? "last" : "first",
                       net.uniform ? "uniform" : "Glorot's",
                       is_ours() ? " (the suite's)" : "");
  }
};

inline std::vector<Choice> choices() {
  std::vector<Choice> all;
  for (const Index variance : kVariances)
    for (const Net& net : kNets) all.push_back({variance, net});
  return all;
}

}  // namespace physinv::packet_width
