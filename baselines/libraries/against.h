/// How often joint optimization ends below a solver, on the same problems.
#pragma once

#include <string>
#include <vector>

#include "suite/evidence/run_values.h"

namespace libraries {

/// The network alone, and refined.
inline physinv::Select fit() { return {"jpo", "fit"}; }
inline physinv::Select refined() { return {"jpo", "refine"}; }

/// Shares of a run's problems.
double better(const physinv::Shares& s);
double equal(const physinv::Shares& s);
double f(const physinv::Shares& s);

/// Solvers by themselves that were run with JPO, in the order of the
/// experiment: those of the plug-in with the settings of the suite's BFGS, then
/// those that were run from Python.
std::vector<std::string> solvers_of(const physinv::Evidence& evidence);

}  // namespace libraries
