#include "suite/cases/common/claims.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "suite/harness/errors.h"

/// Names and texts of claim_texts.S.in in turn, each ended by a zero.
extern "C" const char physinv_claim_texts[];

namespace physinv {

std::vector<ClaimsOfExperiment> claims_of_folder(
    const std::string& folder,
    ClaimNames names,
    const std::string& experiment) {
  for (const char* at = physinv_claim_texts; *at != '\0';) {
    const std::string_view name = at, text = at + name.size() + 1;
    if (name == folder) {
      try {
        return read_claims(text,
                           fmt::format("suite/cases/{}/claims.md", folder),
                           names,
                           experiment);
      } catch (const ClaimDocumentError& error) {
        throw UsageError(error.what());
      }
    }
    at = text.data() + text.size() + 1;
  }
  throw UsageError(fmt::format(
      "there is no suite/cases/{}/claims.md, which add_claims reads; write it, "
      "or remove add_claims from the line in experiments.def",
      folder));
}

void add_claims_of_folder(Registry& registry,
                          const std::string& folder,
                          ClaimNames names) {
  for (ClaimsOfExperiment& e : claims_of_folder(folder, std::move(names)))
    registry.add_claims(e.experiment, std::move(e.claims));
}

void add_claims_of_experiment(Registry& registry,
                              const std::string& folder,
                              const std::string& experiment,
                              ClaimNames names) {
  auto all = claims_of_folder(folder, std::move(names), experiment);
  if (all.empty())
    throw UsageError(fmt::format(
        "suite/cases/{}/claims.md has no part '{}'", folder, experiment));
  registry.add_claims(experiment, std::move(all.front().claims));
}

}  // namespace physinv
