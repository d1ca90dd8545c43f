/// The tables of what is registered: <paper>/experiments.cpp has a line for
/// each experiment in the order of the cases, <paper>/claims.cpp for its
/// claims, pages and what its paper says of all. Folders of experiments have no
/// header: a table declares what it names.
#pragma once

#include <string>
#include <vector>

#include "suite/harness/registry.h"

namespace physinv {

/// What the folder of an experiment defines: `add_experiments`
/// (experiment.cpp), `add_claims` (claims.cpp), `add_reports` (figures.cpp).
using Add = void(Registry&);

/// Experiments alone: what runs, without claims and pages.
Add add_experiments;

/// A folder of suite/cases by what its sources add: the source that
/// cmake/write_registration.cmake makes of some folders has them.
struct CaseFolder {
  std::string path;  ///< <paper>/<folder>
  Add* add;
};
std::vector<CaseFolder> folders();

/// Of problems' columns (suite/harness/quantities.h).
void name_quantities();

namespace jpo {
Add add_experiments, add_claims;
}
namespace hig {
Add add_experiments, add_claims;
}
namespace physgrad {
Add add_experiments, add_claims;
}
namespace sip {
Add add_experiments, add_claims;
}
namespace matrix {
Add add_experiments, add_reports;
}
namespace numerics {
Add add_experiments, add_claims;
}

}  // namespace physinv
