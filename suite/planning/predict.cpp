#include "suite/planning/predict.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "suite/harness/registry.h"

namespace physinv {
namespace {

/// What a worker needs before it does anything: code, libraries, registry.
constexpr double kBaseMemory = 24e6;
/// HDF5's tables of a case and of each stage; a line of the journal.
constexpr double kCaseDisk = 6e3, kStageDisk = 4e3;
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

/// Chains that differ in n and seed alone.
using Kind =
    std::tuple<std::string, std::string, Precision, std::vector<Index>>;

Kind kind_of(const Case& c) {
  return {
      c.info.experiment, c.info.method, c.info.precision, c.stage_iterations};
}

struct Sizes {
  const Case* smallest = nullptr;
  const Case* largest = nullptr;
};

std::map<Kind, Sizes> sizes_of(const std::vector<Case>& cases) {
  std::map<Kind, Sizes> all;
  for (const Case& c : cases) {
    Sizes& s = all[kind_of(c)];
    if (s.smallest == nullptr || c.info.n < s.smallest->info.n) s.smallest = &c;
    if (s.largest == nullptr || c.info.n > s.largest->info.n) s.largest = &c;
  }
  return all;
}

/// Of a stage, the trials with few and with many samples.
struct StageTrials {
  const StageTrial *few, *many;

  template <class F>
  double at(Index n, F&& of) const {
    return on_line(
        of(*few), of(*many), few->n, many->n, static_cast<double>(n));
  }
};

void add_stage(Cost& cost, Index n, const StageTrials& t) {
  const double kept = t.at(n, [](auto& s) { return s.kept; });
  cost.stage_seconds.push_back(
      t.at(n, [](auto& s) { return s.setup + s.seconds + s.measure; }));
  cost.seconds += cost.stage_seconds.back();
  cost.disk += kStageDisk + kept;
  cost.memory = std::max(cost.memory,
                         t.at(n, [](auto& s) { return s.memory; }) + 3 * kept);
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

/// The trials of a kind, from few samples to many.
std::vector<Trial> trials_of(const Sizes& s, Trials& trials) {
  const Index least = s.smallest->info.n, most = s.largest->info.n;
  const auto whole = [&](Index n) {
    return trials.of(resized(*s.smallest, n, s.smallest->stage_iterations),
                     false);
  };
  const Index few = std::min(least, kFewSamples);
  std::vector<Trial> all = {whole(few)};
  const double room = kWholeSeconds / std::max(seconds_of(all[0]), 1e-6);
  const auto fits = static_cast<Index>(
      std::min(static_cast<double>(few) * room, static_cast<double>(most)));
  if (fits >= 2 * few || fits == most) all.push_back(whole(fits));
  if (fits < most) all.push_back(trials.of(*s.largest, true));
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

std::vector<Cost> predict(const std::vector<Case>& cases,
                          Trials& trials,
                          const std::function<void(const Case&)>& say) {
  std::map<Kind, std::vector<Trial>> known;
  for (const auto& [kind, sizes] : sizes_of(cases)) {
    const std::size_t ran = trials.ran();
    known[kind] = trials_of(sizes, trials);
    if (say && trials.ran() > ran) say(*sizes.smallest);
  }
  std::vector<Cost> costs;
  for (const Case& c : cases) {
    const std::vector<Trial>& all = known.at(kind_of(c));
    Cost cost{.disk = kCaseDisk + data_bytes(c)};
    for (std::size_t k = 0; k < all.front().size(); ++k)
      add_stage(cost, c.info.n, {&all.front()[k], last_with(all, k)});
    cost.memory += kBaseMemory;
    costs.push_back(std::move(cost));
  }
  return costs;
}

}  // namespace physinv
