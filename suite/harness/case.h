/// Experiments and the cases they expand to.
#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "suite/core/method.h"
#include "suite/core/recipe.h"
#include "suite/evidence/claim.h"
#include "suite/results/published.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"
#include "suite/store/record.h"

namespace physinv {

struct Citation {
  std::string paper;  ///< key of reports/published/<paper>.json
  std::string where;  ///< "Sec. 4, Fig. 4"
};

/// One line of a profile: the product of its lists.
struct Row {
  std::vector<std::string> methods;
  std::vector<Index> n;
  std::vector<std::uint64_t> seeds;
  Index iterations = 0;  ///< 0: each stage's own default
  Precision precision = Precision::f32;
};

/// 0, 1, ... of so many seeds.
inline std::vector<std::uint64_t> first_seeds(std::uint64_t count) {
  std::vector<std::uint64_t> seeds(count);
  std::iota(seeds.begin(), seeds.end(), std::uint64_t{0});
  return seeds;
}

/// Methods on the first seeds, each for so many updates or steps.
inline Row row(std::vector<std::string> methods,
               Index n,
               std::uint64_t seeds,
               Index iterations = 0,
               Precision precision = Precision::f32) {
  return {.methods = std::move(methods),
          .n = {n},
          .seeds = first_seeds(seeds),
          .iterations = iterations,
          .precision = precision};
}

inline std::vector<Row> joined(std::vector<Row> a, const std::vector<Row>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

struct Profile {
  std::string name;
  std::vector<Row> rows;
};

/// Tables and figures from a campaign's results. The experiment asks, of an
/// overview its paper; whose section it is, the program writes down.
using Report = std::function<Section(const Evidence&)>;

struct Experiment {
  std::string name;   ///< jpo/billiards
  std::string title;  ///< Billiards
  Citation citation;
  ProblemRecipe problem;
  Setting setting;
  std::vector<Profile> profiles;
  std::vector<Method> methods;
  /// Profiles in ascending order are what the claims' `from` refers to.
  std::vector<Claim> claims;
  PlotStyles styles;  ///< colours and markers of methods in every figure
  Report report;      ///< empty: claims alone
};

/// What pages show before several experiments: what their paper says of them
/// together, tables of all.
struct Overview {
  std::string paper;  ///< jpo: of all experiments jpo/...
  std::string title;
  std::vector<std::string> profiles;  ///< in ascending order
  std::vector<Claim> claims;
  Report report = {};
};

/// One case: what it is, and how to run it.
struct Case {
  CaseInfo info;
  std::shared_ptr<const Experiment> experiment;
  const Method* method = nullptr;
  std::vector<Index> stage_iterations;
  /// Of the experiment, found out when first asked for, as networks are made
  /// for it.
  std::shared_future<CaseSize> size;

  /// Declared work of a stage, and of all, for the ETA.
  double operations(std::size_t stage) const;
  double operations() const;
};

/// Null if the experiment has none of this id.
const Method* find_method(const Experiment& e, std::string_view id);

/// Sizes of an experiment that do not change from case to case.
CaseSize size_of(const Experiment& e);

/// A row's case on n samples; without content keys.
Case declared_case(const std::shared_ptr<const Experiment>& e,
                   const Method& method,
                   const std::string& profile,
                   const Row& row,
                   Index n,
                   std::uint64_t seed,
                   const std::shared_future<CaseSize>& size);

/// The same chain on n samples, with so many iterations for each stage;
/// without content keys.
Case resized(const Case& c, Index n, std::vector<Index> iterations);

}  // namespace physinv
