#include "suite/cases/jpo/common/shares.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "suite/core/check.h"

namespace physinv {
namespace {

constexpr std::string_view kBfgs = "bfgs", kSolve = "solve", kRefine = "refine";

bool are_equal(double a, double b, Equality equality) {
  if (equality == Equality::strict || !std::isfinite(b)) return a == b;
  const double wide = equality == Equality::band ? 1e-3 : 1e-6;
  return std::abs(a - b) <= wide * std::abs(b);
}

std::optional<double> deviation(std::span<const double> values) {
  const auto found = mean_std(values);
  return found ? found->std : std::nullopt;
}

}  // namespace

Shares compare_losses(VectorIn<double> loss,
                      VectorIn<double> bfgs,
                      Equality equality) {
  SUITE_CHECK(loss.size() == bfgs.size() && loss.size() > 0,
              "losses of the same problems");
  Index better = 0, equal = 0;
  for (Index i = 0; i < loss.size(); ++i) {
    if (!std::isfinite(loss[i])) continue;
    if (are_equal(loss[i], bfgs[i], equality)) {
      ++equal;
    } else if (!(loss[i] >= bfgs[i])) {  // also where BFGS has NaN
      ++better;
    }
  }
  const auto count = static_cast<double>(loss.size());
  return {static_cast<double>(better) / count,
          static_cast<double>(equal) / count,
          static_cast<double>(loss.size() - better - equal) / count};
}

std::optional<double> decrease_share(VectorIn<double> start,
                                     VectorIn<double> fit,
                                     VectorIn<double> refined) {
  double sum = 0;
  Index count = 0;
  for (Index i = 0; i < fit.size(); ++i) {
    const double end =
        std::isfinite(refined(i)) ? std::min(fit(i), refined(i)) : fit(i);
    const double share = (start(i) - fit(i)) / (start(i) - end);
    if (!std::isfinite(share)) continue;  // no decrease, or no number
    sum += share;
    ++count;
  }
  if (count == 0) return {};
  return sum / static_cast<double>(count);
}

Solved::Solved(double loss)
    : Solved(
          [loss](const CaseData&, const StageRecord& stage, Index example) {
            return stage.loss[example] < loss;
          },
          fmt::format("loss < {:g}", loss)) {}

Index Solved::count(const CaseData& data, const StageRecord& stage) const {
  Index count = 0;
  for (Index i = 0; i < stage.loss.size(); ++i) count += test_(data, stage, i);
  return count;
}

Solved within_of_truth(double tolerance) {
  return {[tolerance](
              const CaseData& data, const StageRecord& stage, Index example) {
            return ((stage.x.col(example) - data.x.col(example)).array().abs() <
                    tolerance)
                .all();
          },
          fmt::format("every unknown within {:g} of the truth", tolerance)};
}

const StageRecord* JpoMetrics::stage(std::string_view method,
                                     Index n,
                                     std::uint64_t seed,
                                     std::string_view name) const {
  const StageRecord* found = results_.find(experiment_, method, n, seed, name);
  const bool ran = found != nullptr && found->stop != Stop::failed &&
                   found->stop != Stop::skipped && found->loss.size() > 0;
  return ran ? found : nullptr;
}

const StageRecord* JpoMetrics::ending(std::string_view method,
                                      Index n,
                                      std::uint64_t seed,
                                      bool refined) const {
  if (refined) return stage(method, n, seed, kRefine);
  const CaseRecord* found = results_.find_case(experiment_, method, n, seed);
  if (found == nullptr) return nullptr;
  const auto& names = found->info.stages;
  const auto last = std::find_if(
      names.rbegin(), names.rend(), [](auto& name) { return name != kRefine; });
  return last == names.rend() ? nullptr : stage(method, n, seed, *last);
}

std::optional<Shares> JpoMetrics::shares(std::string_view method,
                                         Index n,
                                         std::uint64_t seed,
                                         bool refined,
                                         Equality equality) const {
  const StageRecord* ours = ending(method, n, seed, refined);
  const StageRecord* bfgs = stage(kBfgs, n, seed, kSolve);
  if (ours == nullptr || bfgs == nullptr) return {};
  return compare_losses(ours->loss, bfgs->loss, equality);
}

std::optional<JpoMetrics::Pooled> JpoMetrics::mean_shares(
    std::string_view method,
    std::span<const Index> sizes,
    bool refined,
    Equality equality) const {
  Pooled out;
  std::vector<double> better, equal, f;  // one mean per seed
  for (const std::uint64_t seed : seeds()) {
    Shares sum;
    Index count = 0;
    for (const Index n : sizes) {
      const auto one = shares(method, n, seed, refined, equality);
      if (!one) continue;
      sum.better += one->better, sum.equal += one->equal;
      sum.worse += one->worse, ++count;
    }
    if (count == 0) continue;
    out.mean.better += sum.better, out.mean.equal += sum.equal;
    out.mean.worse += sum.worse, out.pairs += count;
    better.push_back(sum.better / static_cast<double>(count));
    equal.push_back(sum.equal / static_cast<double>(count));
    f.push_back(sum.f() / static_cast<double>(count));
  }
  if (out.pairs == 0) return {};
  const auto pairs = static_cast<double>(out.pairs);
  out.mean.better /= pairs, out.mean.equal /= pairs, out.mean.worse /= pairs;
  out.better_std = deviation(better);
  out.equal_std = deviation(equal);
  out.f_std = deviation(f);
  return out;
}

std::optional<double> JpoMetrics::share_of_decrease(std::string_view method,
                                                    Index n,
                                                    std::uint64_t seed,
                                                    bool from_prior) const {
  const StageRecord* fit = ending(method, n, seed, false);
  const StageRecord* refined = ending(method, n, seed, true);
  const StageRecord* begins = from_prior ? stage(kBfgs, n, seed, kSolve) : fit;
  if (fit == nullptr || refined == nullptr || begins == nullptr) return {};
  const Curve& curve = begins->curve;
  if (curve.points() == 0 || curve.iteration.front() != 0) return {};
  return decrease_share(curve.loss.col(0), fit->loss, refined->loss);
}

std::optional<double> JpoMetrics::solved_share(std::string_view method,
                                               Index n,
                                               std::uint64_t seed,
                                               bool refined,
                                               const Solved& solved) const {
  const StageRecord* found = ending(method, n, seed, refined);
  if (found == nullptr) return {};
  return static_cast<double>(solved.count(data(method, n, seed), *found)) /
         static_cast<double>(found->loss.size());
}

}  // namespace physinv
