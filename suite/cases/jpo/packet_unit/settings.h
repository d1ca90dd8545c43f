/// The units that the wave packet's unknown is counted in, and the classical
/// rules and first steps, which see them.
#pragma once

#include <fmt/format.h>

#include <string>

#include "suite/core/batch.h"

namespace physinv::packet_unit {

/// Samples in one unit.
inline constexpr Index kUnits[] = {8, 32, 128};

/// A study for each; a table of all is with the first one.
inline std::string name_of(Index unit) {
  return fmt::format("studies/wave-packet-unit-{}", unit);
}

struct Rule {
  const char *id, *title;
  bool bold;  ///< bold_descent.h, else gradient_descent.h
  double first_step;
};
inline constexpr Rule kRules[] = {
    {"gd-1e-1", "adaptive, 0.1", false, 0.1},
    {"gd-1e-2", "adaptive, 1e-2", false, 1e-2},
    {"gd-1e-4", "adaptive, 1e-4", false, 1e-4},
    {"bold-1e-1", "bold driver, 0.1", true, 0.1},
    {"bold-1e-4", "bold driver, 1e-4", true, 1e-4}};

struct Choice {
  Index unit;
  const Rule* rule;

  std::string title() const {
    const bool ours = unit == 128 && rule == &kRules[0];
    return fmt::format(
        "{} samples, {}{}", unit, rule->title, ours ? " (the suite's)" : "");
  }
};

}  // namespace physinv::packet_unit
