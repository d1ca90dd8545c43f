// What claims.md uses and formulas cannot express.
#include <cmath>
#include <string>
#include <vector>

#include "problems/billiards/billiards.h"
#include "suite/cases/jpo/common/claim_names.h"

namespace physinv::jpo::billiards {
namespace {

constexpr double kSolved = 1e-6;

/// 1 where a run ends with the loss of a miss: the other ball stays.
std::vector<double> on_plateau(const Run& run) {
  const CaseData& data = run.record->data;
  const Vector<double> level =
      0.5 * (data.given - data.y).colwise().squaredNorm();
  const auto there =
      (run.stage->loss - level).array().abs() <= 1e-12 * level.array();
  std::vector<double> flags;
  for (Index i = 0; i < level.size(); ++i) flags.push_back(there(i));
  return flags;
}

/// Neither there nor solved.
std::vector<double> elsewhere(const Run& run) {
  auto flags = on_plateau(run);
  for (std::size_t i = 0; i < flags.size(); ++i)
    flags[i] =
        flags[i] == 0 && !(run.stage->loss(static_cast<Index>(i)) < kSolved);
  return flags;
}

/// The start (1, 0) passes the other ball.
bool start_misses(const Run& run, Index i) {
  return std::abs(run.record->data.given(1, i) - 0.5) >= 0.4;
}

/// At every n <= 32, |f - 1/2| beyond two standard errors is at most half of
/// its mean over n >= 64.
Condition small_differences(const std::string& label, const Select& runs) {
  std::vector<Quantity> distances;
  for (const Index n : {2, 4, 8, 16, 32}) {
    const Quantity at_n = mean(at(runs, n), f());
    distances.emplace_back(
        [=](const Evidence& e) {
          Measured m = at_n(e);
          if (!m.value) return m;
          *m.value =
              std::abs(*m.value - 0.5) -
              2 * m.spread.value_or(0) / std::sqrt(static_cast<double>(m.runs));
          return m;
        },
        at_n.runs());
  }
  const RunValue distance = [](const Run& run) -> std::optional<double> {
    const auto value = f()(run);
    if (!value) return {};
    return std::abs(*value - 0.5);
  };
  return at_most(
      label, most(distances), times(0.5, mean(runs.of_sizes(64), distance)));
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = jpo::claim_names();
  names.set("on_plateau", on_plateau);
  names.set("elsewhere", elsewhere);
  names.set("start_misses", Problems(start_misses));
  names.set("beyond_training",
            jpo::beyond_training(problems::billiards(), 0.02));
  names.add("small_differences", [](const Select& runs) {
    return Labelled([=](const std::string& label) {
      return std::vector{small_differences(label, runs)};
    });
  });
  add_claims_of_folder(r, "jpo/billiards", names);
}

}  // namespace physinv::jpo::billiards
