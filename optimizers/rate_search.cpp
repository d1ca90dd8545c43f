#include "optimizers/rate_search.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "optimizers/stage.h"
#include "suite/core/check.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

constexpr double kNotFinite = 1e300;  // JSON and HDF5 keep numbers

TrainingOptions at_rate(TrainingOptions options, double rate) {
  if (auto* step = std::get_if<StepOptions>(&options.rule)) {
    std::visit([&](auto& o) { o.rate = rate; }, *step);
  } else if (auto* half = std::get_if<HalfInverseStepOptions>(&options.rule)) {
    half->rate = rate;
  } else if (auto* hessian = std::get_if<AdaHessianOptions>(&options.rule)) {
    hessian->rate = rate;
  } else {
    std::get<HessianFreeOptions>(options.rule).rate = rate;
  }
  return options;
}

/// Mean loss after a training on the search's own data.
double searched(const Stage& stage, const RateSearch& search, StageRun& run) {
  const Rng own = run.batches.child("rate_search");
  Oracle oracle = run.oracle.sibling(search.problems, own, stage.needs());
  const auto updates = std::max<Index>(
      1, std::llround(search.share * static_cast<double>(run.iterations)));
  Probe probe(oracle, updates);
  StageRun trial{.oracle = oracle,
                 .probe = probe,
                 .setting = run.setting,
                 .previous = run.previous,
                 .network_init = run.network_init,
                 .batches = own.child("batches"),
                 .method = own.child("method"),
                 .iterations = updates,
                 .precision = run.precision,
                 .threads = run.threads};
  const Outcome out = stage.run(trial);
  Vector<double> loss(oracle.count());
  oracle.measure(out.x, loss);
  const double mean = loss.mean();
  return out.stop != Stop::diverged && std::isfinite(mean) ? mean : kNotFinite;
}

}  // namespace

std::shared_ptr<const Stage> train_at_best_rate(const TrainingOptions& options,
                                                const RateSearch& search) {
  SUITE_CHECK(!search.rates.empty() &&
                  std::is_sorted(search.rates.begin(), search.rates.end()),
              "a search needs rates in ascending order");
  const auto plain = train(options);
  Options words = plain->options();
  std::erase_if(words, [](const auto& o) { return o.first == "rate"; });
  words.insert(
      words.end(),
      {{"searched_rates", fmt::format("{}", fmt::join(search.rates, " "))},
       {"search_share", fmt::format("{}", search.share)},
       {"search_problems", fmt::format("{}", search.problems)}});
  const double trials = search.share * static_cast<double>(search.rates.size());
  const auto tuned = [options, search](StageRun& run) {
    const auto count = static_cast<Index>(search.rates.size());
    Batch<double> rates(1, count), loss(1, count);
    for (Index i = 0; i < count; ++i) {
      rates(i) = search.rates[static_cast<std::size_t>(i)];
      loss(i) = searched(*train(at_rate(options, rates(i))), search, run);
    }
    Index best = 0;
    loss.row(0).minCoeff(&best);
    Outcome out = train(at_rate(options, rates(best)))->run(run);
    out.arrays["rate"] = rates.col(best);
    out.arrays["searched_rates"] = std::move(rates);
    out.arrays["searched_loss"] = std::move(loss);
    return out;
  };
  return make_stage({.name = plain->name(),
                     .needs = plain->needs(),
                     .options = std::move(words),
                     .iterations = options.iterations,
                     .own_length = options.own_length,
                     .operations =
                         [plain, trials](const CaseSize& size) {
                           return (1 + trials) * plain->operations(size);
                         },
                     .sources = plain->sources()},
                    tuned,
                    tuned);
}

}  // namespace physinv
