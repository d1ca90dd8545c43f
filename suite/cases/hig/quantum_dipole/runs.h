/// What the quantum dipole's runs are asked: numbers of one run, and of all
/// seeds of a method.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "suite/cases/hig/quantum_dipole/claims.h"
#include "suite/results/results.h"

namespace physinv::dipole {

/// A number of one run; empty if the run is too short to tell.
using Value = std::function<std::optional<double>(const StageRecord&)>;

/// Test loss after so many updates.
Value loss_after(double updates);

/// The value of runs of at least `enough` updates: in shorter ones only fast
/// seeds would show.
Value if_long(double enough, const Value& value);

/// Updates until the test loss is below `level`, infinite if it never is.
Value until(double level, double enough);

/// Longest stretch of updates with a test loss between 0.4 and 0.56.
std::optional<double> stalled(const StageRecord& s);

/// Updates until HE < 0.1 over updates until LE < 0.1.
std::optional<double> lag(const StageRecord& s);

/// Largest rise of LE over its lowest value so far, until HE < 0.1.
std::optional<double> rise(const StageRecord& s);

/// Median test loss of the last three points of the curve.
Value settled(double enough);

/// One number for each seed of a method that has it.
class Seeds {
 public:
  Seeds(const Results& results,
        std::string_view method,
        const Value& value,
        const char* experiment = kDense);

  bool any() const { return !values_.empty(); }
  std::optional<double> middle() const;
  std::optional<double> lowest() const { return ranked(0); }
  std::optional<double> highest() const { return ranked(count() - 1); }
  /// The bound that four seeds of five keep (two of three), from above and
  /// from below.
  std::optional<double> most_below() const { return ranked(enough() - 1); }
  std::optional<double> most_above() const {
    return ranked(count() - enough());
  }
  /// The smallest ratio of a pair of one seed.
  std::optional<double> smallest_ratio(const Seeds& other) const;

 private:
  Index count() const { return static_cast<Index>(values_.size()); }
  Index enough() const { return std::max<Index>(1, 4 * count() / 5); }
  std::vector<double> sorted() const;
  std::optional<double> ranked(Index i) const;

  std::map<std::uint64_t, double> values_;
};

}  // namespace physinv::dipole
