// What every method of every registered experiment promises
// (suite/core/method.h), on small cases.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "problems/navier_stokes/navier_stokes.h"
#include "suite/diagnostics/diagnostic.h"
#include "suite/harness/run_stage.h"
#include "suite/nn/mlp.h"
#include "tests/support/bits.h"
#include "tests/support/memory_checkpoint.h"
#include "tests/support/quadratic.h"
#include "tests/support/registered.h"

namespace physinv::test {
namespace {

struct Cell {
  ExperimentPtr experiment;
  std::string method;
};
void PrintTo(const Cell& c, std::ostream* out) {
  *out << c.experiment->name << ' ' << c.method;
}

/// What decides which code a method runs: the problem, the networks and the
/// options, all without their numbers.
std::string code_of(const Experiment& e, const Method& method) {
  std::string code, text = e.problem.name + ' ' +
                           e.setting.predictor.recipe.description + ' ' +
                           e.setting.surrogate.recipe.description;
  for (const auto& stage : method.chain) {
    if (dynamic_cast<const Diagnostic*>(stage.get()) != nullptr) {
      // Its options are a hash of all points that it looks at.
      text += ' ' + e.name + ' ' + stage->name();
      continue;
    }
    for (const auto& [name, value] : stage->options())
      text += ' ' + name + '=' + value;
  }
  bool number = false;
  for (const char c : text) {
    number =
        (c >= '0' && c <= '9') ||
        (number && std::string_view(".e+-").find(c) != std::string_view::npos);
    if (!number) code += c;
  }
  return code;
}

/// The methods of the smoke profiles, one of those that are the same code with
/// other numbers.
std::vector<Cell> cells() {
  std::vector<Cell> all;
  std::set<std::pair<std::string, OutputForm>> seen;
  for (const auto& e : registry().experiments())
    for (const Profile& profile : e->profiles)
      for (const Row& row : profile.rows)
        for (const Method& m : e->methods)
          if (profile.name == "smoke" &&
              std::ranges::count(row.methods, m.id) > 0 &&
              seen.emplace(code_of(*e, m), e->setting.output_form).second)
            all.push_back({e, m.id});
  return all;
}

std::string cell_name(const testing::TestParamInfo<Cell>& info) {
  return test_name(info.param.experiment->name + "_" + info.param.method);
}

/// The same with a shorter way from x to y where that takes long; shapes and
/// code are the same.
ExperimentPtr brief(const ExperimentPtr& experiment) {
  if (experiment->problem.name != "navier_stokes") return experiment;
  Experiment shorter = *experiment;
  shorter.problem = problems::navier_stokes({.end_time = 8, .steps = 4});
  return std::make_shared<const Experiment>(std::move(shorter));
}

/// What learns from other problems may overflow on these.
bool own_losses(const StageRecord& r) {
  return option(r.options, "algorithm") != "training";
}

/// Runs of every stage: one that saves its state after `update` updates, where
/// it did, one that continues from there, and one with three threads, in which
/// what follows the first stage continues from its record.
struct Runs {
  std::vector<StageRecord> first, second, threaded;
  std::vector<bool> restored;
};

StageRecord run_one(const Case& c,
                    std::size_t position,
                    std::optional<Outcome>& from,
                    Threads* pool,
                    Checkpoint* checkpoint) {
  StageRecord record;
  record.case_name = c.info.name;
  record.stage = c.info.stages[position];
  run_stage(c, position, from, true, {}, pool, checkpoint, record);
  return record;
}

Runs run_thrice(const Case& c, Index update) {
  Runs all;
  std::optional<Outcome> previous;
  Threads pool(1);
  const std::size_t stages = c.method->chain.size();
  for (std::size_t i = 0; i < stages; ++i) {
    MemoryCheckpoint checkpoint(update);
    const auto one = [&](std::vector<StageRecord>& to) {
      std::optional<Outcome> from = previous;
      to.push_back(run_one(c, i, from, &pool, &checkpoint));
      return from;
    };
    auto outcome = one(all.first);
    if (checkpoint.state) outcome = one(all.second);
    if (!checkpoint.state) all.second.push_back(all.first.back());
    all.restored.push_back(checkpoint.restored);
    previous = std::move(outcome);
  }
  if (stages == 1) {
    all.threaded = run(c, {}, 3);
    return all;
  }
  Threads three(3);
  std::optional<Outcome> nothing;
  all.threaded = {run_one(c, 0, nothing, &three, nullptr)};
  for (StageRecord& r : run(c, {all.first.front()}, 3))
    all.threaded.push_back(std::move(r));
  return all;
}

/// Trainings can be long: they continue from the middle.
bool trains(const StageRecord& r) {
  return r.stage == "fit" && r.iterations == 5 &&
         !option(r.options, "step").empty();
}

/// Abilities of the problem that a stage did not ask for, and one that it did.
void expect_untouched(const StageRecord& r, Needs needs) {
  const auto check = [&](Needs need, Counter counter) {
    if (contains(needs, need)) return;
    EXPECT_EQ(r.counts[counter], 0U)
        << kCounterNames[static_cast<std::size_t>(counter)];
  };
  check(Needs::forward, Counter::forward);
  check(Needs::vjp, Counter::vjp);
  check(Needs::jacobian, Counter::jacobian);
  check(Needs::inverse, Counter::inverse);
  if (contains(needs, Needs::vjp)) {
    EXPECT_GT(r.counts[Counter::vjp], 0U);
  }
}

class MethodContract : public testing::TestWithParam<Cell> {
 protected:
  static Case make(Index n,
                   Index iterations,
                   Precision precision = Precision::f32) {
    return small_case(brief(GetParam().experiment),
                      GetParam().method,
                      n,
                      iterations,
                      precision);
  }
  /// Those that make a difference.
  static std::vector<Precision> precisions() {
    const Case c = make(3, 1);
    const bool both = std::ranges::any_of(
        c.method->chain, [](const auto& s) { return s->has_precision(); });
    return both ? std::vector{Precision::f32, Precision::f64}
                : std::vector{Precision::f32};
  }
  /// Looks at problems instead of solving them, which may take long.
  static bool looks() {
    const Case c = make(3, 1);
    return std::ranges::all_of(c.method->chain, [](const auto& s) {
      return option(s->options(), "algorithm") == "diagnostic";
    });
  }
};

void expect_finite(const Case& c,
                   const std::vector<StageRecord>& records,
                   Index iterations) {
  const Shape shape = c.experiment->problem.make<double>()->shape();
  ASSERT_EQ(records.size(), c.method->chain.size());
  for (const StageRecord& r : records) {
    SCOPED_TRACE(r.stage);
    ASSERT_NE(r.stop, Stop::failed) << r.message;
    ASSERT_NE(r.stop, Stop::skipped);
    EXPECT_LE(r.iterations, iterations);
    EXPECT_EQ(r.x.rows(), shape.unknowns);
    EXPECT_EQ(r.x.cols(), 3);
    EXPECT_TRUE(r.x.allFinite());
    ASSERT_EQ(r.loss.size(), 3);
    if (own_losses(r)) {
      EXPECT_TRUE(r.loss.allFinite());
    }
    EXPECT_EQ(r.status.size(), 3U);
    ASSERT_EQ(r.example_iterations.size(), 3);
    EXPECT_LE(r.example_iterations.maxCoeff(), iterations);
    EXPECT_EQ(r.example_evaluations.size(), 3);
    for (const auto& [name, array] : r.arrays)
      EXPECT_TRUE(array.allFinite()) << name;
  }
}

void expect_whole_curves(const Case& c,
                         const std::vector<StageRecord>& records) {
  const Index unknowns = c.experiment->problem.make<double>()->shape().unknowns;
  EXPECT_TRUE(contains(c.experiment->problem.provided, c.method->needs()));
  for (std::size_t position = 0; position < records.size(); ++position) {
    const StageRecord& r = records[position];
    SCOPED_TRACE(r.stage);
    const Needs needs = c.method->chain[position]->needs();
    EXPECT_TRUE(contains(c.method->needs(), needs));
    expect_untouched(r, needs);
    const Curve& curve = r.curve;
    const Index points = curve.points();
    ASSERT_GT(points, 0);
    EXPECT_EQ(curve.iteration.front(), 0);
    EXPECT_EQ(curve.iteration.back(), static_cast<double>(r.iterations));
    EXPECT_EQ(curve.seconds.size(), curve.iteration.size());
    EXPECT_EQ(curve.evaluations.size(), curve.iteration.size());
    for (std::size_t k = 1; k < curve.iteration.size(); ++k) {
      EXPECT_LT(curve.iteration[k - 1], curve.iteration[k]);
      EXPECT_LE(curve.seconds[k - 1], curve.seconds[k]);
      EXPECT_LE(curve.evaluations[k - 1], curve.evaluations[k]);
    }
    EXPECT_EQ(curve.loss.rows(), 3);
    EXPECT_EQ(curve.loss.cols(), points);
    EXPECT_EQ(curve.x.rows(),
              std::min<Index>(3, tracked_examples(unknowns)) * unknowns);
    EXPECT_EQ(curve.x.cols(), points);
    if (own_losses(r)) {
      EXPECT_TRUE(curve.loss.allFinite());
    }
    EXPECT_TRUE(curve.x.allFinite());
  }
}

// Of five updates where it repeats itself.
TEST_P(MethodContract, ObeysItsBudgetAndLeavesFiniteEstimates) {
  const auto lengths =
      looks() ? std::vector<Index>{0} : std::vector<Index>{0, 1};
  for (const auto precision : precisions()) {
    for (const Index iterations : lengths) {
      const Case c = make(3, iterations, precision);
      expect_finite(c, run(c), iterations);
    }
  }
}

TEST_P(MethodContract, CurvesAreWholeAndOnlyWhatIsDeclaredIsTouched) {
  if (looks()) GTEST_SKIP() << "is seen to where it repeats itself";
  const Case c = make(3, 12);
  expect_whole_curves(c, run(c));
}

TEST_P(MethodContract, RepeatsItselfForAnyThreadsAndWhenResumed) {
  const Index iterations = looks() ? 12 : 5;
  for (const auto precision : precisions()) {
    const Case c = make(3, iterations, precision);
    const Runs runs = run_thrice(c, 2);
    ASSERT_EQ(runs.first.size(), runs.threaded.size());
    for (std::size_t i = 0; i < runs.first.size(); ++i) {
      expect_same(runs.first[i], runs.second[i]);
      expect_same(runs.first[i], runs.threaded[i]);
      if (trains(runs.first[i])) {
        EXPECT_TRUE(runs.restored[i]);
      }
    }
    looks() ? expect_whole_curves(c, runs.first)
            : expect_finite(c, runs.first, iterations);
  }
}

// Estimates that are chosen by their loss are no worse than any on the way.
TEST_P(MethodContract, KeepsTheBestWhereItPromisesTo) {
  const Case c = make(8, 12, Precision::f64);
  const std::set<std::string> ends_there = {
      "bfgs", "lbfgsb", "gradient_descent"};
  std::set<std::string> promise = {"jpo", "neural_adjoint"};
  promise.insert(ends_there.begin(), ends_there.end());
  if (std::ranges::none_of(c.method->chain, [&](const auto& s) {
        return s->name() == "refine" ||
               promise.contains(option(s->options(), "algorithm"));
      }))
    GTEST_SKIP() << "promises nothing";
  Vector<double> before;
  for (const StageRecord& r : run(c)) {
    const auto algorithm = option(r.options, "algorithm");
    SCOPED_TRACE(algorithm);
    for (Index i = 0; i < 8; ++i) {
      const double best = r.curve.loss.row(i).minCoeff();
      if (promise.contains(algorithm)) {
        EXPECT_LE(r.loss(i), best);
      }
      if (ends_there.contains(algorithm)) {
        EXPECT_EQ(r.loss(i), best);
      }
      if (r.stage == "refine") {
        EXPECT_LE(r.loss(i), before(i));
      }
    }
    before = r.loss;
  }
}

// The same method on a problem with a known optimum.
TEST_P(MethodContract, LowersAQuadratic) {
  const Case own = make(3, 1);  // keeps its experiment
  for (const auto& stage : own.method->chain) {
    const auto algorithm = option(stage->options(), "algorithm");
    if (algorithm == "diagnostic" || algorithm == "prior_guess")
      GTEST_SKIP() << "looks or guesses instead of solving";
    const std::string rate = option(stage->options(), "rate");
    const std::string step = option(stage->options(), "step");
    if (((step == "sgd" || algorithm == "gradient") &&
         std::stod(rate) < 1e-4) ||
        (step == "adadelta" && std::stod(rate) < 1e-2))
      GTEST_SKIP() << "a rate for gradients of another size";
  }
  auto experiment = std::make_shared<Experiment>(*GetParam().experiment);
  experiment->problem = quadratic();
  // Small, as some experiments have rates that only small networks survive.
  const auto net = nn::mlp({.hidden = {8}, .activation = nn::Activation::tanh});
  experiment->setting.predictor = {{Field::given, Field::observations}, net};
  experiment->setting.surrogate = {{Field::unknowns, Field::given}, net};
  experiment->setting.output_form = OutputForm::linear;
  experiment->setting.gtol = Setting{}.gtol;  // that of others is their loss's
  if (!contains(experiment->problem.provided, own.method->needs()))
    GTEST_SKIP() << "needs what the quadratic does not provide";
  const Case c =
      small_case(experiment, GetParam().method, 16, 600, Precision::f64);
  const auto records = run(c);
  const double start = records.front().curve.loss.col(0).mean();
  for (const StageRecord& r : records) {
    ASSERT_NE(r.stop, Stop::failed) << r.message;
    const auto algorithm = option(r.options, "algorithm");
    SCOPED_TRACE(algorithm);
    if (algorithm == "surrogate") {
      EXPECT_LT(r.arrays.at("training_loss")(0, 0), 1);
    } else if (algorithm == "bfgs" || algorithm == "gradient_descent") {
      EXPECT_EQ(r.stop, Stop::converged);
      EXPECT_LT(r.loss.maxCoeff(), 1e-8);
    } else {
      EXPECT_LT(r.loss.mean(), 0.9 * start);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Registered,
                         MethodContract,
                         testing::ValuesIn(cells()),
                         cell_name);

}  // namespace
}  // namespace physinv::test
