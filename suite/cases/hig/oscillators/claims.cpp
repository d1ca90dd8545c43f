#include "suite/cases/hig/oscillators/claims.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "suite/cases/hig/common/report.h"
#include "suite/cases/hig/oscillators/methods.h"
#include "suite/cases/jpo/common/claims.h"

namespace physinv::oscillators {
namespace {

constexpr Index kEarly = 320, kLate = 2000;

std::optional<double> loss(const Results& results,
                           const std::string& method,
                           Index updates) {
  return median_test_loss(results, kName, method, updates);
}

/// The lower of those that are there.
std::optional<double> lower(std::optional<double> a, std::optional<double> b) {
  return a && b ? std::min(a, b) : a ? a : b;
}

/// The largest factor by which a curve rises above what it had reached.
double largest_rise(const StageRecord& stage) {
  const auto& losses = stage.arrays.at("mean_loss");
  double lowest = losses(0, 0), rise = 0;
  for (Index k = 0; k < losses.cols(); ++k) {
    rise = std::max(rise, losses(0, k) / lowest);
    lowest = std::min(lowest, losses(0, k));
  }
  return rise;
}

std::optional<double> highest_rise(const Results& results,
                                   const std::string& method) {
  std::optional<double> most;
  for (const auto* s : trained_stages(results, kName, method))
    most = std::max(most.value_or(0), largest_rise(*s));
  return most;
}

ClaimResult hig_level(const Results& results) {
  Judge judge;
  const auto early = loss(results, "hig", kEarly);
  judge.at_least("median after 320", early, 1e-4)
      .at_most("median after 320", early, 2e-3);
  if (const auto late = loss(results, "hig", kLate)) {
    judge.at_least("after 2000", late, 5e-6).at_most("after 2000", late, 2e-4);
  }
  judge.at_most("rise over the lowest so far", highest_rise(results, "hig"), 2);
  return std::move(judge).result(
      "A1",
      "HIG brings the test loss to 1e-4 .. 2e-3 in 320 updates, to 5e-6 .. "
      "2e-4 in 2000, and never above twice what it had reached",
      "quick");
}

ClaimResult hig_beats_adam_by_the_papers_clock(const Results& results,
                                               const Published& published) {
  Judge judge;
  const auto longer =
      ratio(paper_update(published, kName, "table3/hig/b=128"),
            paper_update(published, kName, "table3/adam/b=512"));
  const auto against_adam = [&](Index updates) -> std::optional<double> {
    if (!longer) return {};
    const auto meanwhile = static_cast<double>(updates) * *longer;
    return ratio(loss(results, "hig", updates),
                 loss(results, "adam", static_cast<Index>(meanwhile)));
  };
  judge.below("HIG over Adam, 320 updates", against_adam(kEarly), 0.2);
  if (const auto late = against_adam(kLate))
    judge.below("2000 updates", late, 0.2);
  for (const char* other : {"sgd", "adadelta", "rmsprop"})
    judge.above(fmt::format("{} over Adam, 300 updates", other),
                loss(results, other, 300),
                loss(results, "adam", 300));
  return std::move(judge).result(
      "A2",
      "By the paper's clock HIG is below a fifth of Adam after 320 and 2000 "
      "updates; at equal updates Adam leads the first-order rules",
      "quick");
}

ClaimResult gauss_newton_is_unstable(const Results& results) {
  Judge judge;
  int seeds = 0, unstable = 0;
  std::optional<double> early, late;  // of the best run that is stable
  for (const auto* s : trained_stages(results, kName, "gn")) {
    ++seeds;
    const auto& losses = s->arrays.at("mean_loss");
    if (s->stop == Stop::diverged || losses.maxCoeff() > 3 * losses(0, 0)) {
      ++unstable;
    } else {
      early = lower(early, test_loss(s, kEarly));
      late = lower(late, test_loss(s, kLate));
    }
  }
  if (seeds < 8) {
    judge.missing("8 seeds of Gauss-Newton");
  } else {
    judge.at_least(
        fmt::format("unstable of {} seeds", seeds), double(unstable), 1);
  }
  if (early)
    judge.at_most("best stable over HIG, 320 updates",
                  ratio(early, loss(results, "hig", kEarly)),
                  10);
  if (late)
    judge.report("2000 updates", ratio(late, loss(results, "hig", kLate)));
  return std::move(judge).result(
      "A3",
      "Of 8 seeds at least one of Gauss-Newton diverges or triples its loss; "
      "its best stable run is within a factor 10 of HIG",
      "standard");
}

/// After 256 updates and, where runs are longer, after 1024. The loss of one
/// seed with kappa = 0, a step of fixed length, jumps by a factor of ten.
ClaimResult half_is_best(const Results& results) {
  Judge judge;
  if (trained_stages(results, kName, "kappa-0").size() < 5)
    judge.missing("five seeds of each exponent");
  for (const Index updates : {256, 1024}) {
    const auto at = [&](const char* id) { return loss(results, id, updates); };
    const auto half = at("kappa-m05"), none = at("kappa-0");
    if (updates > 256 && !half) break;
    std::optional<double> lowest;
    for (const Exponent& e : kExponents)
      if (e.kappa != -0.5) lowest = lower(lowest, at(e.id));
    const auto say = [&](const char* what) {
      return fmt::format("{}, {} updates", what, updates);
    };
    judge.at_most(
        say("kappa=-1/2 over the lowest other"), ratio(half, lowest), 2);
    judge.above(say("kappa=1/2"), at("kappa-05"), 0.1);
    judge.above(say("kappa=0 over -1/2"), ratio(none, half), 10);
  }
  return std::move(judge).result(
      "A4",
      "Of the exponents kappa, -1/2 ends lowest (to a factor 2); 1/2 ends "
      "above 0.1, 0 ten times higher",
      "quick");
}

ClaimResult beta_is_a_shorter_step(const Results& results) {
  Judge judge;
  const auto none = loss(results, "kappa-m05", 256);
  const auto quarter = ratio(loss(results, "beta-m250", 256), none);
  const auto half = ratio(loss(results, "beta-m500", 256), none);
  judge.at_least("beta=-1/4 over 0", quarter, 5)
      .at_most("beta=-1/4 over 0", quarter, 40)
      .at_least("beta=-1/2 over 0", half, 30)
      .at_most("beta=-1/2 over 0", half, 250);
  return std::move(judge).result(
      "A5",
      "At equal updates (256, b = 64) beta=-1/4 is 5 .. 40 times, -1/2 30 .. "
      "250 times above beta=0; the paper saw little influence",
      "standard");
}

ClaimResult tau_hardly_matters(const Results& results) {
  const auto spread = [&](std::vector<std::string> ids, auto&& loss_of) {
    std::optional<double> widest;
    for (const std::uint64_t seed : results.seeds(kName)) {
      std::vector<double> losses;
      for (const auto& id : ids)
        if (const auto* s = trained_stage(results, kName, id, seed))
          if (const std::optional<double> one = loss_of(s))
            losses.push_back(*one);
      if (losses.size() < ids.size()) continue;
      const auto [lo, hi] = std::minmax_element(losses.begin(), losses.end());
      widest = std::max(widest.value_or(0), *hi / *lo);
    }
    return widest;
  };
  std::vector<std::string> some = {
      "hig-tau5", "kappa-m05", "hig-tau7", "hig-tau8"};
  Judge judge;
  judge.at_most("highest over lowest, 256 updates, 1e-5 .. 1e-8",
                spread(some, [](const auto* s) { return test_loss(s, 256); }),
                1.1);
  some.insert(some.end(), {"hig-tau9", "hig-tau10"});
  judge.at_most("at the end, 1e-5 .. 1e-10",
                spread(some,
                       [](const auto* s) {
                         return std::optional(
                             s->arrays.at("mean_loss").rightCols(1).value());
                       }),
                10);
  return std::move(judge).result(
      "A6",
      "HIG depends little on tau: within 10 % for each seed after 256 updates "
      "(1e-5 .. 1e-8), within a factor 10 at the end (to 1e-10)",
      "standard");
}

ClaimResult larger_batches_help_later(const Results& results) {
  Judge judge;
  for (const Index updates : {128, 256})
    judge.above(fmt::format("b=32, {} updates, over b=64", updates),
                loss(results, "hig-b32", updates),
                loss(results, "kappa-m05", updates));
  const auto level =
      ratio(loss(results, "hig", 256), loss(results, "kappa-m05", 256));
  judge.at_least("b=128 over 64, 256 updates", level, 0.5)
      .at_most("b=128 over 64, 256 updates", level, 2);
  judge.above("b=32 over b=128, 1024 updates",
              loss(results, "hig-b32", 1024),
              loss(results, "hig", 1024));
  double lo = std::numeric_limits<double>::infinity(), hi = 0;
  for (const char* id : {"adam-b256", "adam", "adam-b1024"}) {
    const auto one = loss(results, id, 4000);
    if (!one) judge.missing(id);
    lo = std::min(lo, one.value_or(lo)), hi = std::max(hi, one.value_or(hi));
  }
  if (hi > 0) judge.at_most("Adam, highest over lowest b", hi / lo, 3);
  return std::move(judge).result(
      "A7",
      "HIG with b=64 beats b=32 after 128 and 256 updates, b=128 is level with "
      "64 and ahead of 32 after 1024; Adam's batch size matters little",
      "standard");
}

}  // namespace

std::vector<ClaimResult> claims(const Results& results,
                                const Published& published) {
  return {hig_level(results),
          hig_beats_adam_by_the_papers_clock(results, published),
          gauss_newton_is_unstable(results),
          half_is_best(results),
          beta_is_a_shorter_step(results),
          tau_hardly_matters(results),
          larger_batches_help_later(results)};
}

}  // namespace physinv::oscillators
