/// What is registered: experiments.txt has a line for each folder of
/// experiments, in the order of the cases. The table is written from the
/// functions that a folder's sources define (cmake/write_registration.cmake).
#pragma once

#include <string>
#include <vector>

#include "suite/harness/registry.h"

namespace physinv {

/// What the folder of an experiment defines: `add_experiments`
/// (experiment.cpp), `add_claims` (claims.cpp), `add_reports` (figures.cpp).
using Add = void(Registry&);

/// A folder of suite/cases by what its sources add.
struct CaseFolder {
  std::string path;  ///< <paper>/<folder>
  Add* add;
  /// Names, as its line of experiments.txt has them: with a star, all that
  /// begin so.
  std::vector<std::string> experiments;
};
/// Of the program: all, or the one that it is over.
std::vector<CaseFolder> folders();

/// Of problems' columns (suite/harness/quantities.h).
void name_quantities();

}  // namespace physinv
