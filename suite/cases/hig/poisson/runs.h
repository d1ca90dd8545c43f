/// What the Poisson experiment's runs are asked: medians over seeds, of single
/// stages and of pairs, and the singular values that updates kept.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "suite/evidence/curve.h"
#include "suite/results/results.h"

namespace physinv::poisson {

inline constexpr const char* kName = "hig/poisson";

/// Stages by their names: of chains, more than the last are asked for.
class Runs {
 public:
  explicit Runs(const Results& results) : results_(results) {}

  /// One stage of a method for each seed that finished it.
  std::vector<const StageRecord*> all(std::string_view method,
                                      std::string_view stage) const;
  const StageRecord* one(std::string_view method,
                         std::string_view stage,
                         std::uint64_t seed) const;

  /// Medians over the seeds that have a value; empty if none has.
  using Value = std::function<std::optional<double>(const StageRecord&)>;
  std::optional<double> median_of(std::string_view method,
                                  std::string_view stage,
                                  const Value& value) const;
  /// Test loss of the last stage.
  std::optional<double> loss(std::string_view method, double updates) const;
  /// f(stages of one seed), both of them there.
  using Pair = std::function<std::optional<double>(const StageRecord&,
                                                   const StageRecord&)>;
  std::optional<double> median_of_pairs(std::string_view method,
                                        std::string_view stage,
                                        std::string_view other_method,
                                        std::string_view other_stage,
                                        const Pair& value) const;

  const Results& results() const { return results_; }

 private:
  const Results& results_;
};

/// A method's updates by HIG or Gauss-Newton, over all seeds.
struct Phase {
  std::string method;
  Index updates = 0, rows = 0, least_kept = 0, unproven = 0, runs = 0;
  double smallest = std::numeric_limits<double>::infinity();
};

/// Of every method whose records say how many singular values were kept.
std::vector<Phase> phases(const Runs& runs);

}  // namespace physinv::poisson
