/// What stands in the columns of a problem's arrays, told once beside its
/// experiments, for the files of all its cases:
///
///   const bool kNamed = register_quantities(
///       "pendulum", {.unknowns = {"angle, angular velocity"}});
///
/// Columns of a problem that says nothing have no names.
#pragma once

#include <string>

#include "suite/store/record.h"

namespace physinv {

struct Quantities {
  Meaning unknowns, observations, given;
};

/// By the name of the problem's recipe; for static initialisation, true.
bool register_quantities(const std::string& problem, Quantities quantities);

/// Null if there are none.
const Quantities* find_quantities(const std::string& problem);

}  // namespace physinv
