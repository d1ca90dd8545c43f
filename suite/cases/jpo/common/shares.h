/// What the inverse-problem cases of the JPO paper compare: M8 of their
/// methods. Everything is read from finished stages; what needs a stage that
/// is not there is empty ("not run"), never 0.
///
/// Stages: bfgs and gd `solve`; jpo and supervised `fit`, `refine`; na `fit`
/// (the surrogate), `solve` (BFGS on it), `refine`.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "suite/core/batch.h"
#include "suite/evidence/statistics.h"
#include "suite/results/results.h"

namespace physinv {

/// When two losses count as equal: bitwise, |a - b| <= 1e-6 |b|, or 1e-3 |b|,
/// which is nothing where solvers end at kinks.
enum class Equality { strict, tol, band };

/// Shares of problems on which a method ends below, at or above BFGS.
struct Shares {
  double better = 0, equal = 0, worse = 0;
  /// f_N = N_better / N + N_equal / (2 N).
  double f() const { return better + 0.5 * equal; }
};

/// A loss that is not finite is worse; a finite one is better than a BFGS
/// loss that is not. Sizes must agree and be positive.
Shares compare_losses(VectorIn<double> loss,
                      VectorIn<double> bfgs,
                      Equality equality);

/// Share of the decrease made before the refinement, mean over problems:
/// (start - fit) / (start - min(fit, refined)). Problems without decrease are
/// left out; empty if none is left.
std::optional<double> decrease_share(VectorIn<double> start,
                                     VectorIn<double> fit,
                                     VectorIn<double> refined);

/// When a problem counts as solved. A number means a loss below it; any other
/// test sees the data of the case, so that it may ask for the truth.
class Solved {
 public:
  using Test =
      std::function<bool(const CaseData&, const StageRecord&, Index example)>;

  Solved(double loss);  // NOLINT(google-explicit-constructor)
  Solved(Test test, std::string says)
      : test_(std::move(test)), says_(std::move(says)) {}

  bool operator()(const CaseData& data,
                  const StageRecord& stage,
                  Index example) const {
    return test_(data, stage, example);
  }
  /// How many of the stage's examples.
  Index count(const CaseData& data, const StageRecord& stage) const;
  /// "loss < 1e-06"
  const std::string& says() const { return says_; }

 private:
  Test test_;
  std::string says_;
};

/// max_j |x_j - truth_j| < tolerance; an estimate that is not finite is not.
Solved within_of_truth(double tolerance);

/// One experiment of a campaign.
class JpoMetrics {
 public:
  JpoMetrics(const Results& results, std::string_view experiment)
      : results_(results), experiment_(experiment) {}

  std::vector<Index> sizes() const { return results_.sizes(experiment_); }
  std::vector<std::uint64_t> seeds() const {
    return results_.seeds(experiment_);
  }

  /// The finished stage with a loss per problem, else null.
  const StageRecord* stage(std::string_view method,
                           Index n,
                           std::uint64_t seed,
                           std::string_view name) const;
  /// The last stage of the chain that is not `refine`, or `refine` itself.
  const StageRecord* ending(std::string_view method,
                            Index n,
                            std::uint64_t seed,
                            bool refined) const;

  /// Against the `solve` of bfgs on the same n and seed.
  std::optional<Shares> shares(std::string_view method,
                               Index n,
                               std::uint64_t seed,
                               bool refined,
                               Equality equality) const;
  /// Mean of every (n, seed) there is among `sizes`; with `spread`, the
  /// sample deviation over seeds of each seed's mean.
  struct Pooled {
    Shares mean;
    std::optional<double> better_std, equal_std, f_std;
    Index pairs = 0;
  };
  std::optional<Pooled> mean_shares(std::string_view method,
                                    std::span<const Index> sizes,
                                    bool refined,
                                    Equality equality = Equality::strict) const;

  /// decrease_share of the fit, from its curve at iteration 0 or from that of
  /// plain BFGS.
  std::optional<double> share_of_decrease(std::string_view method,
                                          Index n,
                                          std::uint64_t seed,
                                          bool from_prior = false) const;

  /// Share of problems solved at the end of a chain.
  std::optional<double> solved_share(std::string_view method,
                                     Index n,
                                     std::uint64_t seed,
                                     bool refined,
                                     const Solved& solved) const;

 private:
  const CaseData& data(std::string_view method,
                       Index n,
                       std::uint64_t seed) const {
    return results_.find_case(experiment_, method, n, seed)->data;
  }

  const Results& results_;
  std::string_view experiment_;
};

}  // namespace physinv
