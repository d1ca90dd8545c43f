/// Which runs a number is drawn from. Everybody selects runs here, so that
/// "not run" means the same everywhere.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "suite/core/batch.h"

namespace physinv {

class Published;
class Results;
struct CaseRecord;
struct StageRecord;

/// As the last size: there is no last.
inline constexpr Index kEvery = std::numeric_limits<Index>::max();

/// What claims are judged from. `experiment` is meant where none is named.
struct Evidence {
  const Results& results;
  const Published& published;
  std::string experiment;

  /// As if another experiment asked.
  Evidence of(std::string name) const {
    return {results, published, std::move(name)};
  }
};

/// Runs of one method: a stage of its chain, sizes within [first, last].
struct Select {
  std::string method;
  std::string stage = {};  ///< empty: the last of the chain
  Index first = 0, last = kEvery;
  std::string experiment = {};  ///< empty: the one that asks

  Select of_sizes(Index from, Index to = kEvery) const {
    Select s = *this;
    s.first = from, s.last = to;
    return s;
  }
  Select in(std::string name) const {
    Select s = *this;
    s.experiment = std::move(name);
    return s;
  }
  /// "hig/toy gn", "jpo refine, n >= 32"
  std::string text() const;
};

/// One finished stage of one case.
struct Run {
  const Evidence* evidence;
  const CaseRecord* record;
  const StageRecord* stage;

  Index n() const;
  std::uint64_t seed() const;
  /// The run of another method on the same n and seed.
  std::optional<Run> beside(const Select& other) const;
};

/// Those that finished (diverged runs did, failed ones did not), ascending in
/// n and seed.
std::vector<Run> find_runs(const Evidence& evidence, const Select& select);
/// The first of them.
std::optional<Run> first_run(const Evidence& evidence, const Select& select);

/// A number of one run; empty if it does not have it (too short).
using RunValue = std::function<std::optional<double>(const Run&)>;

struct Sample {
  Index n;
  std::uint64_t seed;
  double value;
};
std::vector<Sample> sample(const Evidence& evidence,
                           const Select& select,
                           const RunValue& value);
std::vector<double> values_of(const std::vector<Sample>& samples);
/// Mean over n for each seed, ascending in the seed.
std::vector<double> seed_means(const std::vector<Sample>& samples);

}  // namespace physinv
