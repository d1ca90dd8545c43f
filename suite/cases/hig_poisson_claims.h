/// What the Poisson experiment's runs are asked: phases of chains, spectra, and
/// the claims of HIG paper Figs. 3, 7, Table 4.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "suite/cases/hig_curve.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv::poisson {

inline constexpr const char* kName = "hig/poisson";

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
  std::optional<double> loss(std::string_view method,
                             double updates,
                             std::string_view stage = {}) const;
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

/// Kept singular values and the smallest of them, by method, in phases by HIG
/// and Gauss-Newton.
Table spectrum_table(const Runs& runs);

/// Where the curves of Adam's rates cross, over updates.
Table crossing_table(const Runs& runs);

/// Assertions 1 to 9.
std::vector<ClaimResult> claims(const Runs& runs);

}  // namespace physinv::poisson
