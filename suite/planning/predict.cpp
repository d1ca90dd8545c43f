#include <algorithm>
#include <limits>
#include <map>

#include "suite/planning/kinds.h"
#include "suite/planning/trials.h"

namespace physinv {
namespace {

/// HDF5's tables of a case and of each stage; a line of the journal.
constexpr double kCaseDisk = 6e3, kStageDisk = 5e3;
/// Trials of whole chains take about this long; with more samples, only their
/// training is tried, whose iterations can be cut.
constexpr double kWholeSeconds = 0.4;
constexpr Index kFewSamples = 16;

/// The line through a at n = from and b at n = to: a part that does not follow
/// n, and one that does.
double on_line(double a, double b, double from, double to, double n) {
  if (from == to) return a * n / from;
  const double slope = std::max(0.0, (b - a) / (to - from));
  return std::max(a + slope * (n - from), 0.1 * a);
}

/// Of a stage, the trials with few and with many samples.
struct StageTrials {
  const StageTrial *few, *many;

  template <class F>
  double estimate(Index n, F&& number) const {
    return on_line(
        number(*few), number(*many), few->n, many->n, static_cast<double>(n));
  }
};

void add_stage(Cost& cost, Index n, const StageTrials& t) {
  const double kept = t.estimate(n, [](auto& s) { return s.kept; });
  cost.stage_seconds.push_back(
      t.estimate(n, [](auto& s) { return s.setup + s.seconds + s.measure; }));
  cost.seconds += cost.stage_seconds.back();
  cost.disk += kStageDisk + kept;
  cost.memory = std::max(
      cost.memory, t.estimate(n, [](auto& s) { return s.memory; }) + 3 * kept);
}

double data_bytes(const Case& c) {
  const Shape shape = c.experiment->problem.make<double>()->shape();
  return 8.0 *
         static_cast<double>(
             c.info.n * (shape.unknowns + shape.observations + shape.given));
}

double seconds_of(const Trial& trial) {
  double sum = 0;
  for (const StageTrial& t : trial) sum += t.setup + t.seconds + t.measure;
  return sum;
}

/// What is known of a kind, and `next` for each trial that is asked for; until
/// one has no stage.
template <class Next>
std::vector<Trial> collect(const Sizes& s, Next&& next) {
  const Index least = s.smallest->info.n, most = s.largest->info.n;
  const auto whole = [&](Index n) {
    return next(resized(*s.smallest, n, s.smallest->stage_iterations), false);
  };
  const Index few = std::min(least, kFewSamples);
  std::vector<Trial> all = {whole(few)};
  const double room = kWholeSeconds / std::max(seconds_of(all[0]), 1e-6);
  const auto fits = static_cast<Index>(
      std::min(static_cast<double>(few) * room, static_cast<double>(most)));
  if (fits >= 2 * few || fits == most) all.push_back(whole(fits));
  if (fits < most) all.push_back(next(*s.largest, true));
  return all;
}

/// The last of them that has the stage at k.
const StageTrial* last_with(const std::vector<Trial>& all, std::size_t k) {
  const StageTrial* found = nullptr;
  for (const Trial& trial : all)
    if (k < trial.size()) found = &trial[k];
  return found;
}

}  // namespace

Kind kind_of(const Case& c) {
  return {
      c.info.experiment, c.info.method, c.info.precision, c.stage_iterations};
}

Kinds kinds_of(const std::vector<Case>& cases) {
  Kinds all;
  for (const Case& c : cases) {
    Sizes& s = all[kind_of(c)];
    if (s.smallest == nullptr || c.info.n < s.smallest->info.n) s.smallest = &c;
    if (s.largest == nullptr || c.info.n > s.largest->info.n) s.largest = &c;
  }
  return all;
}

std::vector<Trial> trials_of(const Sizes& s, Trials& trials) {
  return collect(s, [&](const Case& c, bool training_only) {
    return trials.measured(c, training_only);
  });
}

std::vector<Trial> known_trials(const Sizes& s, const Trials& trials) {
  auto all = collect(s, [&](const Case& c, bool training_only) {
    const Trial* known = trials.known(c, training_only);
    return known == nullptr ? Trial() : *known;
  });
  // Without the first there is no estimate.
  if (all.front().empty()) return {};
  std::erase_if(all, [](const Trial& trial) { return trial.empty(); });
  return all;
}

Cost unmeasured_cost(const Case& c) {
  return {.seconds = std::numeric_limits<double>::quiet_NaN(),
          .memory = kProgramMemory,
          .disk = kCaseDisk + data_bytes(c) +
                  kStageDisk * static_cast<double>(c.info.stages.size()),
          .stage_seconds = {}};
}

Cost cost_of(const Case& c, const std::vector<Trial>& all) {
  Cost cost{.disk = kCaseDisk + data_bytes(c)};
  for (std::size_t k = 0; k < all.front().size(); ++k)
    add_stage(cost, c.info.n, {&all.front()[k], last_with(all, k)});
  constexpr double kWide = 2;
  cost.memory += kProgramMemory;
  cost.least = cost.seconds / kWide, cost.most = cost.seconds * kWide;
  return cost;
}

std::vector<Cost> predict(const std::vector<Case>& cases,
                          Trials& trials,
                          const std::function<void(const Case&)>& say) {
  std::map<Kind, std::vector<Trial>> known;
  for (const auto& [kind, sizes] : kinds_of(cases)) {
    const std::size_t ran = trials.ran();
    known[kind] = trials_of(sizes, trials);
    if (say && trials.ran() > ran) say(*sizes.smallest);
  }
  std::vector<Cost> costs;
  for (const Case& c : cases) costs.push_back(cost_of(c, known.at(kind_of(c))));
  return costs;
}

}  // namespace physinv
