#include "suite/cases/common/claims.h"

#include <fmt/format.h>

#include <stdexcept>
#include <string_view>
#include <utility>

/// Names and texts of claim_texts.S in turn, each ended by a zero.
extern "C" const char physinv_claim_texts[];

namespace physinv {

std::vector<ClaimsOfExperiment> claims_of_folder(
    const std::string& folder,
    ClaimNames names,
    const std::string& experiment) {
  for (const char* at = physinv_claim_texts; *at != '\0';) {
    const std::string_view name = at, text = at + name.size() + 1;
    if (name == folder)
      return read_claims(text,
                         fmt::format("suite/cases/{}/claims.md", folder),
                         names,
                         experiment);
    at = text.data() + text.size() + 1;
  }
  throw std::logic_error(
      fmt::format("suite/cases/common/claim_texts.S lacks {}", folder));
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
    throw std::logic_error(
        fmt::format("suite/cases/{}/claims.md lacks {}", folder, experiment));
  registry.add_claims(experiment, std::move(all.front().claims));
}

}  // namespace physinv
