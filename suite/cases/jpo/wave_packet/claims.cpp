// What claims.md uses and formulas cannot express.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "problems/wave_packet/wave_packet.h"
#include "suite/cases/jpo/common/claim_names.h"
#include "suite/cases/jpo/wave_packet/quantities.h"

namespace physinv::jpo::wave_packet {
namespace {

const double kScale = WavePacketOptions{}.scale;
/// Between minima of the loss.
const double kPeriod = 2 * std::numbers::pi / WavePacketOptions{}.frequency;

/// Distance of one guess for all, the middle of the window.
std::vector<double> distances_of_guess(const Run& run) {
  const auto truth = run.record->data.x.row(0);
  const double middle = 0.5 * (truth.minCoeff() + truth.maxCoeff());
  std::vector<double> out;
  for (Index i = 0; i < truth.size(); ++i)
    out.push_back(kScale * std::abs(truth(i) - middle));
  return out;
}

/// 1 where a path that is kept ends nearer to the truth than it started.
std::vector<double> approached(const Run& run) {
  const auto first = first_tracked(0)(run), last = last_tracked(0)(run);
  std::vector<double> flags;
  const auto known = static_cast<std::size_t>(run.record->data.x.cols());
  for (std::size_t i = 0; i < std::min(first.size(), known); ++i) {
    const double truth = run.record->data.x(0, static_cast<Index>(i));
    flags.push_back(std::abs(last[i] - truth) < std::abs(first[i] - truth));
  }
  return flags;
}

/// Of the paths that are kept: the first measured iteration from which on they
/// stay in the minimum where they end.
std::vector<double> settled(const Run& run) {
  const Curve& curve = run.stage->curve;
  std::vector<double> out;
  for (Index i = 0; i < curve.x.rows(); ++i) {
    Index k = curve.points() - 1;
    const double end = curve.x(i, k);
    while (k > 0 && kScale * std::abs(curve.x(i, k - 1) - end) < kPeriod / 2)
      --k;
    out.push_back(curve.iteration[static_cast<std::size_t>(k)]);
  }
  return out;
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = jpo::claim_names();
  names.set("period", kPeriod);
  names.set("distances", distances_in(kScale));
  names.set("first_steps", first_steps_in(kScale));
  names.set("farther_than_bfgs", farther_than_bfgs_in(kScale));
  names.set("distances_of_guess", distances_of_guess);
  names.set("approached", approached);
  names.set("settled", settled);
  names.set("beyond_training",
            jpo::beyond_training(problems::wave_packet(), 0.02));
  add_claims_of_folder(r, "jpo/wave_packet", names);
}

}  // namespace physinv::jpo::wave_packet
