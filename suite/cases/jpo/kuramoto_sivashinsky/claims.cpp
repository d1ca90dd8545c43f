// What claims.md uses and formulas cannot express.
#include <cmath>
#include <vector>

#include "suite/cases/jpo/common/claim_names.h"

namespace physinv::jpo::kuramoto_sivashinsky {
namespace {

const Solved kSolved = within_of_truth(1e-3);

/// The refined run of the same problem is solved.
bool gets_solved(const Run& run, Index i) {
  const auto end = run.beside(kRefined);
  return end && kSolved(end->record->data, *end->stage, i);
}

/// Loss at the end over that of BFGS's start, the mean of the truths.
std::vector<double> loss_over_start(const Run& run) {
  const auto bfgs_run = bfgs_beside(run);
  auto ratios = losses()(run);
  if (!bfgs_run) return {};
  const auto start = start_losses()(*bfgs_run);
  if (start.size() != ratios.size()) return {};
  for (std::size_t i = 0; i < ratios.size(); ++i) ratios[i] /= start[i];
  return ratios;
}

/// Problems that the simulator could not follow.
Quantity diverged_share(const Select& runs) {
  return share_of_examples(
      runs, losses(), [](double loss) { return !std::isfinite(loss); });
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = jpo::claim_names();
  names.set("within", kSolved);
  names.set("gets_solved", Problems(gets_solved));
  names.set("loss_over_start", loss_over_start);
  names.add("diverged_share", diverged_share);
  add_claims_of_folder(r, "jpo/kuramoto_sivashinsky", names);
}

}  // namespace physinv::jpo::kuramoto_sivashinsky
