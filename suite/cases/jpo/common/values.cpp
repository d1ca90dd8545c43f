#include "suite/cases/jpo/common/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "suite/harness/study.h"
#include "suite/results/crowded.h"
#include "suite/results/loss_summary.h"

namespace physinv::jpo {
namespace {

using Value = std::optional<double>;

bool is_solver(const std::string& method) {
  return method == "bfgs" || method == "gd";
}

template <class V>
std::vector<double> list(const V& row) {
  return {row.begin(), row.end()};
}

/// The stage before this one.
std::optional<Run> before(const Run& run) {
  const auto& stages = run.record->stages;
  if (run.stage == &stages.front()) return {};
  return Run{run.evidence, run.record, run.stage - 1};
}

double share_of(const Solved& solved, const Run& run) {
  return static_cast<double>(solved.count(run.record->data, *run.stage)) /
         static_cast<double>(run.stage->loss.size());
}

/// Unknown j of all examples along a curve, at one of its points.
std::vector<double> tracked(const Run& run, Index j, Index point) {
  const Curve& curve = run.stage->curve;
  const Index unknowns = run.stage->x.rows();
  std::vector<double> out;
  if (curve.points() == 0) return out;
  for (Index row = j; row < curve.x.rows(); row += unknowns)
    out.push_back(curve.x(row, point));
  return out;
}

bool is_largest(const Run& run) {
  const Select same{.method = run.record->info.method,
                    .stage = run.stage->stage,
                    .first = run.n() + 1,
                    .experiment = run.record->info.experiment};
  const auto larger = find_runs(*run.evidence, same);
  return std::none_of(larger.begin(), larger.end(), [&](const Run& other) {
    return other.seed() == run.seed();
  });
}

std::vector<double> means_over_seeds(const std::vector<Sample>& samples) {
  std::map<Index, std::vector<double>> sizes;
  for (const Sample& s : samples) sizes[s.n].push_back(s.value);
  std::vector<double> means;
  for (const auto& [n, values] : sizes) means.push_back(mean_of(values));
  return means;
}

Quantity extreme_mean(const Select& select,
                      const RunValue& value,
                      double (*extreme)(std::vector<double>)) {
  return {[=](const Evidence& e) {
            const auto samples = sample(e, select, value);
            if (samples.empty()) return missing(select.text() + " not run");
            return Measured{.value = extreme(means_over_seeds(samples)),
                            .runs = static_cast<Index>(samples.size())};
          },
          {select}};
}

std::vector<Condition> row_of_table(const std::string& table,
                                    const char* prefix,
                                    const Select& runs,
                                    Index seeds) {
  const std::string& method = runs.method;
  const auto one = [&](const char* what, const RunValue& value) {
    return as_printed(fmt::format("{}{} {}, %", prefix, method, what),
                      percent(mean(runs, value)),
                      fmt::format("{}/{}/{}", table, method, what),
                      seeds);
  };
  return {one("better", better()), one("equal", equal())};
}

}  // namespace

Select bfgs() { return {.method = "bfgs", .stage = "solve"}; }
Select gd() { return {.method = "gd", .stage = "solve"}; }
Select plain(const std::string& method) {
  return {.method = method,
          .stage = is_solver(method) || method == "na" ? "solve" : "fit"};
}
Select refined(const std::string& method) {
  return {.method = method, .stage = "refine"};
}
Select ending(const std::string& method, bool is_refined) {
  return is_refined && !is_solver(method) ? refined(method) : plain(method);
}

std::optional<Run> bfgs_beside(const Run& run) {
  return run.beside(bfgs().in(run.record->info.experiment));
}

RunValue better(Equality equality) {
  return against(
      bfgs(), [](const Shares& s) { return s.better; }, equality);
}
RunValue equal(Equality equality) {
  return against(
      bfgs(), [](const Shares& s) { return s.equal; }, equality);
}
RunValue worse() {
  return against(bfgs(), [](const Shares& s) { return s.worse; });
}
RunValue f(Equality equality) {
  return against(
      bfgs(), [](const Shares& s) { return s.f(); }, equality);
}

RunValue solved(const Solved& solved) {
  return [=](const Run& run) -> Value { return share_of(solved, run); };
}

RunValue gain(const Solved& solved) {
  return [=](const Run& run) -> Value {
    const auto other = bfgs_beside(run);
    if (!other) return {};
    return share_of(solved, run) - share_of(solved, *other);
  };
}

RunValue decrease_before(bool from_prior) {
  return [=](const Run& run) -> Value {
    const auto fit = before(run);
    const auto begins = from_prior ? bfgs_beside(run) : fit;
    if (!fit || !begins) return {};
    const Curve& curve = begins->stage->curve;
    if (curve.points() == 0 || curve.iteration.front() != 0) return {};
    const Index problems = run.stage->loss.size();
    if (fit->stage->loss.size() != problems || curve.loss.rows() != problems)
      return {};
    return decrease_share(curve.loss.col(0), fit->stage->loss, run.stage->loss);
  };
}

RunValue worsened() {
  return [](const Run& run) -> Value {
    const auto start = before(run);
    if (!start) return {};
    return static_cast<double>(
        (run.stage->loss.array() > start->stage->loss.array()).count());
  };
}

RunValue mean_loss() {
  return [](const Run& run) { return mean_loss_of(*run.stage); };
}
RunValue worst_loss() {
  return [](const Run& run) { return largest_loss_of(*run.stage); };
}
RunValue over_bfgs(RunValue value) {
  return [value = std::move(value)](const Run& run) -> Value {
    const auto other = bfgs_beside(run);
    if (!other) return {};
    const auto a = value(run), b = value(*other);
    if (!a || !b) return {};
    return *a / *b;
  };
}

RunValue seconds() {
  return [](const Run& run) -> Value { return seconds_to_tell(*run.stage); };
}

RunRow if_solved(const Solved& solved) {
  return [=](const Run& run) {
    std::vector<double> flags;
    for (Index i = 0; i < run.stage->loss.size(); ++i)
      flags.push_back(solved(run.record->data, *run.stage, i));
    return flags;
  };
}

RunRow where(Problems condition, RunRow row) {
  return [=](const Run& run) {
    std::vector<double> picked;
    const auto values = row(run);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (condition(run, static_cast<Index>(i))) picked.push_back(values[i]);
    return picked;
  };
}

Problems is_solved(const Solved& solved) {
  return [=](const Run& run, Index i) {
    return solved(run.record->data, *run.stage, i);
  };
}

Problems bfgs_unsolved(const Solved& solved) {
  return [=](const Run& run, Index i) {
    const auto other = bfgs_beside(run);
    return other && !solved(other->record->data, *other->stage, i);
  };
}

RunRow first_below(double loss) {
  return [=](const Run& run) {
    const Curve& curve = run.stage->curve;
    std::vector<double> first(static_cast<std::size_t>(curve.loss.rows()),
                              std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < first.size(); ++i)
      for (Index k = curve.points() - 1; k >= 0; --k)
        if (curve.loss(static_cast<Index>(i), k) < loss)
          first[i] = curve.iteration[static_cast<std::size_t>(k)];
    return first;
  };
}

RunRow start_losses() {
  return [](const Run& run) {
    const Curve& curve = run.stage->curve;
    return curve.points() == 0 ? std::vector<double>{}
                               : list(curve.loss.col(0));
  };
}

RunRow last_tracked(Index j) {
  return [=](const Run& run) {
    return tracked(run, j, run.stage->curve.points() - 1);
  };
}
RunRow first_tracked(Index j) {
  return [=](const Run& run) { return tracked(run, j, 0); };
}

namespace {

/// The ends of the training samples' range, by experiment, seed and number of
/// samples: a flow's are drawn with their observations, which takes seconds.
class TrainingRanges {
 public:
  struct Range {
    Vector<double> low, high;
  };

  explicit TrainingRanges(ProblemRecipe problem)
      : problem_(std::move(problem)) {}

  const Range& of(const CaseInfo& info, Index samples) {
    Range& known = known_[{info.experiment, info.seed, samples}];
    if (known.low.size() > 0) return known;
    const Rng stream = root_of(info.experiment, info.seed).child("data/train");
    const Batch<double> x =
        problem_.make<double>()->sample_labelled(0, samples, stream).x;
    known = {x.rowwise().minCoeff(), x.rowwise().maxCoeff()};
    return known;
  }

 private:
  ProblemRecipe problem_;
  std::map<std::tuple<std::string, std::uint64_t, Index>, Range> known_;
};

}  // namespace

RunRow beyond_training(const ProblemRecipe& problem,
                       double margin,
                       Index per_problem) {
  const auto ranges = std::make_shared<TrainingRanges>(problem);
  return [=](const Run& run) {
    const auto& range = ranges->of(run.record->info, per_problem * run.n());
    std::vector<double> beyond;
    for (Index j = 0; j < range.low.size(); ++j) {
      const double low = range.low(j), high = range.high(j);
      const double edge = margin * (high - low);
      const auto ends = last_tracked(j)(run);
      beyond.resize(ends.size());
      for (std::size_t i = 0; i < ends.size(); ++i)
        if (ends[i] <= low + edge || ends[i] >= high - edge) beyond[i] = 1;
    }
    return beyond;
  };
}

RunRow largest_sets(RunRow row) {
  return [=](const Run& run) {
    return is_largest(run) ? row(run) : std::vector<double>{};
  };
}
RunValue largest_sets(RunValue value) {
  return [=](const Run& run) { return is_largest(run) ? value(run) : Value{}; };
}

Quantity lowest_mean(const Select& select, const RunValue& value) {
  return extreme_mean(select, value, least_of);
}
Quantity highest_mean(const Select& select, const RunValue& value) {
  return extreme_mean(select, value, most_of);
}

Quantity percent_better(const Select& select) {
  return percent(mean(select, better()));
}

Condition better_more_often(std::string label,
                            const Select& a,
                            const Select& b) {
  return above(std::move(label), mean(a, better()), mean(b, better()));
}
Quantity solved_share(const Select& select, const Solved& solved) {
  return share_of_examples(select, if_solved(solved), holds);
}

Quantity problem_count(const Select& select) {
  return {[=](const Evidence& e) {
            double count = 0;
            for (const Run& run : find_runs(e, select))
              if (is_largest(run))
                count += static_cast<double>(run.stage->loss.size());
            return Measured{.value = count};
          },
          {select}};
}

Quantity from_problems(Index problems, const Select& select, Quantity q) {
  const Quantity count = problem_count(select);
  return {[=](const Evidence& e) {
            const Measured there = count(e);
            if (!there.value) return there;
            if (*there.value >= static_cast<double>(problems)) return q(e);
            return missing(
                fmt::format("{} of {} problems", select.text(), problems));
          },
          q.runs(),
          q.printed()};
}

std::vector<Condition> table4(const std::string& method, Index seeds) {
  return row_of_table("table4", "", plain(method), seeds);
}
std::vector<Condition> table5(const std::string& method, Index seeds) {
  return row_of_table("table5", "refined ", refined(method), seeds);
}

std::vector<Condition> table3(Index seeds, bool from_prior) {
  std::vector<PrintedMean> means;
  for (const Index n : {4, 8, 32, 128})
    means.push_back(
        {fmt::format("made by the network, n = {}, %", n),
         percent(mean(at(refined("jpo"), n), decrease_before(from_prior))),
         fmt::format("table3/n={}", n)});
  return jointly_as_printed(
      "probability of such differences from Table 3", std::move(means), seeds);
}

}  // namespace physinv::jpo
