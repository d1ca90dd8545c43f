/// Claims of an experiment's folder, written in its claims.md.
#pragma once

#include <string>
#include <vector>

#include "suite/evidence/claim_document.h"
#include "suite/harness/registry.h"

namespace physinv {

/// Those of suite/cases/<folder>/claims.md, or of one of its experiments.
/// Throws UsageError of a mistake in the text, with its place, and of a folder
/// without one.
std::vector<ClaimsOfExperiment> claims_of_folder(
    const std::string& folder,
    ClaimNames names = claim_names(),
    const std::string& experiment = "");

/// Registers them.
void add_claims_of_folder(Registry& registry,
                          const std::string& folder,
                          ClaimNames names = claim_names());

/// Registers those of one experiment of the folder, with names that are its
/// own. Throws UsageError if the document has none.
void add_claims_of_experiment(Registry& registry,
                              const std::string& folder,
                              const std::string& experiment,
                              ClaimNames names);

}  // namespace physinv
