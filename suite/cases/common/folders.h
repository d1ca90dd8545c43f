/// What is registered, as suite/cases/common/experiments.def lists it.
#pragma once

#include <string>
#include <vector>

#include "suite/harness/registry.h"

namespace physinv {

/// What the sources of a folder define: `add_experiments` (experiment.cpp),
/// `add_claims` (claims.cpp), `add_reports` (figures.cpp).
using Add = void(Registry&);

/// A folder of suite/cases by what its sources add.
struct CaseFolder {
  std::string path;        ///< <paper>/<folder>
  std::vector<Add*> adds;  ///< in their order
  /// Names; with a star, all that begin so.
  std::vector<std::string> experiments;

  void add(Registry& r) const {
    for (Add* one : adds) one(r);
  }
};
/// Of the program: all, or the one that it is over.
std::vector<CaseFolder> folders();

}  // namespace physinv
