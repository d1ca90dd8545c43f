// JPO paper, Secs. 2-3, Fig. 2: how often do noisy gradients, and the updates
// of a network trained with them, point the right way?
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "problems/noisy_absolute/noisy_absolute.h"
#include "suite/cases/jpo/gradient_alignment/measurement.h"
#include "suite/cases/jpo/gradient_alignment/shares.h"
#include "suite/harness/registry.h"

namespace physinv::alignment {
namespace {

constexpr NoisyAbsoluteOptions kSine{};
constexpr NoisyAbsoluteOptions kLinear{
    .solution = Solution::linear, .gamma = 1, .terms = 0};
constexpr NoisyAbsoluteOptions kKnown{
    .solution = Solution::zero, .level = 10, .snr = kWeak};
constexpr NoisyAbsoluteOptions kUnequal{
    .solution = Solution::zero, .level = 10, .decades = 2, .snr = kWeak};

const TinyNetOptions kSineNet{};
const TinyNetOptions kLinearNet{.hidden = {32, 32, 32},
                                .activation = TinyActivation::tanh,
                                .scale = 40,
                                .range = 1};

/// Of gradients of some ten: none is smaller, and sums of it are exact.
constexpr double kLowThreshold = 0x1p-30;

Method measure(std::string id,
               const NoisyAbsoluteOptions& data,
               std::optional<TinyNetOptions> network = {}) {
  return {.id = std::move(id),
          .chain = {measurement(data, std::move(network), kFull)}};
}

Method clipped(std::string id, const NoisyAbsoluteOptions& data) {
  return {.id = std::move(id),
          .chain = {measurement(data, {}, kFull, kLowThreshold)}};
}

Row row(std::vector<std::string> methods,
        std::vector<Index> n,
        Index repetitions) {
  return {.methods = std::move(methods),
          .n = std::move(n),
          .seeds = {0},
          .iterations = repetitions};
}

Profile profile(std::string name,
                const std::vector<Index>& n,
                Index repetitions) {
  return {
      .name = std::move(name),
      .rows = {row({"known", "unequal", "linear", "sine"}, n, repetitions)}};
}
/// And gradients that are clipped.
Profile with_clipped(Profile p) {
  p.rows.push_back(
      row({"clipped", "clipped-unequal"}, p.rows[0].n, p.rows[0].iterations));
  return p;
}

const std::vector<Index> kSizes{1, 2, 4, 8, 16, 32, 64, 128, 256};

Experiment experiment() {
  Experiment e;
  e.name = kName;
  e.title = "Gradient alignment";
  e.citation = {.paper = "jpo", .where = "Secs. 2-3, Fig. 2, Apps. A, B"};
  e.problem = problems::noisy_absolute(kSine);
  e.profiles = {profile("smoke", {1, 2, 4, 8}, 20),
                profile("quick", kSizes, kJudged),
                with_clipped(profile("paper", kSizes, kFull))};
  e.methods = {measure("known", kKnown),
               measure("unequal", kUnequal),
               measure("linear", kLinear, kLinearNet),
               measure("sine", kSine, kSineNet),
               clipped("clipped", kKnown),
               clipped("clipped-unequal", kUnequal)};
  return e;
}

}  // namespace

void add_experiments(Registry& r) { r.add(experiment()); }

}  // namespace physinv::alignment
