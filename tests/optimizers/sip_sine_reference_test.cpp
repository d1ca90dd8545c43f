// The vectors of sip-sine: the problem itself, and training through the stage
// on listed samples from listed weights.
#include <algorithm>
#include <stdexcept>
#include <string>

#include "optimizers/training.h"
#include "optimizers/training/newton.h"
#include "optimizers/training/proxy.h"
#include "problems/sine_plane/sine_plane.h"
#include "suite/nn/mlp.h"
#include "tests/support/listed.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kId = "sip-sine";
constexpr auto kBoth = {Precision::f64, Precision::f32};

/// The sine on a list of observations.
ProblemRecipe listed_sine(const std::vector<Pair>& pairs,
                          const SinePlaneOptions& options) {
  const auto n = static_cast<Index>(pairs.size());
  Batch<double> y(2, n);
  for (Index i = 0; i < n; ++i) {
    const Pair& pair = pairs[static_cast<std::size_t>(i)];
    y.col(i) << pair[0], pair[1];
  }
  return with_samples(problems::sine_plane(options),
                      {Batch<double>::Zero(2, n), y, Batch<double>(0, n)});
}

Setting sine_setting() {
  return {
      .predictor = {{Field::observations}, nn::mlp({.hidden = {32, 64, 32}})},
      .surrogate = {}};
}

const std::vector<TensorInfo>& sine_tensors() {
  static const auto net = sine_setting().predictor.recipe.make<double>(2, 2);
  return net->tensors();
}

Batch<double> sine_weights(const Json& rule) {
  return recurrence_weights(rule, sine_tensors());
}

/// In single precision the network's own rounding is stretched by b = 320.
Comparator tolerance_of(const Json& entry, Precision precision) {
  const Comparator exact = EntryTolerance(entry.at("tolerance")).array();
  return precision == Precision::f64
             ? exact
             : Comparator(1e-4, std::max(exact.atol(), 1e-6));
}

/// Entries of training leave gamma to the specification.
SinePlaneOptions options_of(const Json& in) {
  return {.gamma = in.value("gamma", 10.0),
          .xi = in.at("xi"),
          .degrees = in.at("phi_degrees")};
}

template <class T>
void check_point_in(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const SinePlaneOptions options = options_of(in);
  const auto same = std::is_same_v<T, double>
                        ? tolerance_of(entry, Precision::f64)
                        : Comparator(3e-3, 1e-5);  // u is up to 640 here
  const AnyProblem<T> problem(problems::sine_plane(options));
  const Batch<T> x = vector(in.at("x"), 2).cast<T>(),
                 target = vector(in.at("y_target"), 2).cast<T>(), given(0, 1);
  Batch<T> y(2, 1), y_bar(2, 1), gradient(2, 1), hessian(4, 1), found(2, 1);
  Workspace work;
  Tape tape;
  Vector<double> loss(1);
  problem.linearize(x, given, y, tape);
  problem.loss(y, target, loss);
  problem.loss_gradient(y, target, y_bar);
  problem.pullback(tape, y_bar, gradient, work);
  problem.hessian(x, given, target, hessian, work);
  problem.invert(target, given, x, found, work);
  const auto expect = [&](const Batch<double>& got, const char* key) {
    const Json value = want.at(key);
    const Batch<double> wanted =
        value.is_number() ? Batch<double>::Constant(1, 1, value)
        : value.front().is_array()
            ? Batch<double>(Eigen::Map<const Batch<double>>(
                  rows(value, 2, 2).eval().data(), 4, 1))
            : Batch<double>(vector(value));
    EXPECT_TRUE(same(got, wanted)) << entry.at("name") << ' ' << key;
  };
  expect(y.template cast<double>(), "y");
  expect(loss, "loss");
  expect(gradient.template cast<double>(), "gradient");
  expect(hessian.template cast<double>(), "hessian");
  expect((found - x).template cast<double>(), "step_limited");
}

void check_point(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  check_point_in<double>(entry);
  check_point_in<float>(entry);
  SinePlaneOptions options = options_of(in);
  const Pair x = in.at("x"), target = in.at("y_target");
  const auto same = tolerance_of(entry, Precision::f64);
  const auto expect = [&](const Pair& got, const char* key) {
    EXPECT_TRUE(same(Vector<double>(Eigen::Vector2d(got[0], got[1])),
                     vector(want.at(key))))
        << entry.at("name") << ' ' << key;
  };
  const Pair there = nearest_solution(options, x, target);
  expect(there, "closest");
  EXPECT_TRUE(same(std::hypot(x[0] - there[0], x[1] - there[1]),
                   number(want.at("distance"))));
  expect(limited_newton_step(options, x, target), "step_limited");
  options.limit = 1e300;
  expect(limited_newton_step(options, x, target), "step_unlimited");
  // The eigenvalues in the turned frame are those of the Hessian without a
  // turn.
  const Vector<double> eigenvalues = vector(want.at("eigenvalues"), 2);
  const double c = std::cos(options.degrees * M_PI / 180),
               s = std::sin(options.degrees * M_PI / 180);
  const Batch<double> w{{c * x[0] - s * x[1]}, {s * x[0] + c * x[1]}};
  options.degrees = 0;
  Batch<double> straight(4, 1);
  Workspace work;
  AnyProblem<double>(problems::sine_plane(options))
      .hessian(w,
               Batch<double>(0, 1),
               Eigen::Vector2d(target[0], target[1]),
               straight,
               work);
  EXPECT_TRUE(same(Eigen::Vector2d(std::min(straight(0), straight(3)),
                                   std::max(straight(0), straight(3)))
                       .eval(),
                   eigenvalues));
}

struct SineRun {
  SinePlaneOptions problem = {};
  std::vector<Pair> samples;
  Index batch, updates;
  StepOptions rule = SgdOptions{.rate = 1};
  SignalRecipe signal = solver_loss();
  Precision precision = Precision::f64;
};

Outcome run(const Json& rule, const SineRun& r) {
  const auto stage =
      train({.rule = r.rule, .batch = r.batch, .signal = r.signal});
  StageBench bench(*stage,
                   static_cast<Index>(r.samples.size()),
                   r.updates,
                   listed_sine(r.samples, r.problem),
                   sine_setting());
  Outcome before;
  before.arrays["parameters"] = sine_weights(rule);
  before.arrays["state"] = Batch<double>(0, 1);
  return bench.run(&before, r.precision);
}

void check_network(const Json& entry) {
  const Json& in = entry.at("inputs");
  for (const Precision p : kBoth) {
    const std::vector<Pair> samples = in.at("y");
    const auto out = run(in.at("weights"),
                         {.samples = samples,
                          .batch = static_cast<Index>(samples.size()),
                          .updates = 0,
                          .precision = p});
    EXPECT_TRUE(
        tolerance_of(entry, p)(out.x, columns(entry.at("expected").at("x"))));
  }
}

SignalRecipe signal_of(const std::string& method, const std::string& loss) {
  if (method == "grad") return solver_loss();
  if (method != "sip" || (loss != "l1" && loss != "l2"))
    throw std::runtime_error("no test knows the method " + method + " " + loss);
  return inverse_proxy(loss == "l1" ? ProxyNorm::absolute : ProxyNorm::square);
}

/// A step of length one is the gradient.
void check_gradient(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const std::string method = in.at("method"), loss = in.at("sip_loss");
  const std::vector<Pair> samples = in.at("y");
  const auto count = static_cast<Index>(samples.size());
  const SinePlaneOptions options = options_of(in);
  for (const Precision p : kBoth) {
    // Sums of single precision cancel: relative to the largest of them.
    const auto same =
        p == Precision::f64
            ? tolerance_of(entry, p)
            : Comparator(1e-3, 1e-4 * number(want.at("gradient_norm")));
    const auto out = run(in.at("weights"),
                         {.problem = options,
                          .samples = samples,
                          .batch = count,
                          .updates = 1,
                          .signal = signal_of(method, loss),
                          .precision = p});
    const Vector<double> step =
        (sine_weights(in.at("weights")) - out.arrays.at("parameters")).col(0);
    EXPECT_TRUE(same(step.norm(), number(want.at("gradient_norm"))));
    const Vector<double> first = vector(want.at("gradient_first")),
                         last = vector(want.at("gradient_last"));
    ASSERT_LE(std::max(first.size(), last.size()), step.size());
    EXPECT_TRUE(same(step.head(first.size()), first));
    EXPECT_TRUE(same(step.tail(last.size()), last));
  }
  // The adjoints, from the first estimates.
  const Batch<double> x = run(in.at("weights"),
                              {.problem = options,
                               .samples = samples,
                               .batch = count,
                               .updates = 0})
                              .x;
  const AnyProblem<double> problem(problems::sine_plane(options));
  const Batch<double> target = columns(in.at("y")), given(0, count);
  Batch<double> y(2, count), adjoint(2, count);
  Workspace work;
  Tape tape;
  if (method == "sip") {
    problem.invert(target, given, x, adjoint, work);
    adjoint = x - adjoint;
    if (loss == "l1") adjoint = adjoint.array().sign();
  } else {
    problem.linearize(x, given, y, tape);
    problem.pullback(tape, y - target, adjoint, work);
  }
  EXPECT_TRUE(tolerance_of(entry, Precision::f64)(
      Batch<double>(adjoint / double(count)), columns(want.at("adjoint"))));
}

/// Rates and decays of the specification (section 4), which has one for SGD
/// that goes with xi.
StepOptions rule_of(const Json& in, const std::string& method, double xi) {
  const double given = in.value("lr", 0.0);
  const auto rate = [&](double specified) {
    return given > 0 ? given : specified;
  };
  if (method == "sgd") return SgdOptions{.rate = rate(1e-2 / (xi * xi))};
  if (method == "adadelta")
    return AdadeltaOptions{.rate = rate(3e-3), .decay = 0.9, .eps = 1e-6};
  if (method == "adagrad")
    return AdagradOptions{.rate = rate(3e-3), .accumulator = 0, .eps = 1e-10};
  if (method == "rmsprop")
    return RmspropOptions{.rate = rate(3e-5), .decay = 0.99, .eps = 1e-8};
  if (method == "adam" || method.starts_with("sip"))
    return AdamOptions{.rate = rate(1e-3), .eps = 1e-8};
  throw std::runtime_error("no test knows the method " + method);
}

/// First batch, second, first, ...
void check_sine_steps(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const std::string name = entry.at("name");
  const std::string method = name.substr(std::string("three-steps-").size());
  const SinePlaneOptions options = options_of(in);
  const StepOptions rule = rule_of(in, method, options.xi);
  const SignalRecipe signal = method.starts_with("sip-")
                                  ? signal_of("sip", method.substr(4))
                                  : signal_of("grad", "");
  std::vector<Pair> samples = in.at("batch_1");
  const std::vector<Pair> second = in.at("batch_2");
  ASSERT_EQ(samples.size(), second.size()) << "one batch size for all";
  const auto batch = static_cast<Index>(samples.size());
  samples.insert(samples.end(), second.begin(), second.end());
  const Json after = want.at("outputs_after_step");
  const auto steps = static_cast<Index>(after.size());
  for (const Precision p : kBoth) {
    const auto same = tolerance_of(entry, p);
    for (Index k = 1; k <= steps; ++k) {
      const auto out = run(in.at("weights"),
                           {.problem = options,
                            .samples = samples,
                            .batch = batch,
                            .updates = k,
                            .rule = rule,
                            .signal = signal,
                            .precision = p});
      EXPECT_TRUE(
          same(Batch<double>(out.x.leftCols(batch)), columns(after[k - 1])))
          << name << ' ' << k;
      if (k < steps) continue;
      EXPECT_TRUE(same(out.arrays.at("parameters").norm(),
                       number(want.at("parameter_norm"))))
          << name;
    }
  }
}

TEST(SipSineReference, AllEntries) {
  check_entries(kId,
                {{"point-*", check_point},
                 {"network-forward", check_network},
                 {"training-gradient-*", check_gradient},
                 {"three-steps-*", check_sine_steps}});
}

// At saddles, maxima and exact solutions: finite, and never uphill.
TEST(SinePlane, StepsAreFiniteAndGoDown) {
  Rng rng = Rng::root("sine", 0);
  Stream stream = rng.stream();
  int uphill = 0;
  for (int k = 0; k < 20'000; ++k) {
    const SinePlaneOptions options{.xi = k % 2 == 0 ? 1.0 : 64.0,
                                   .degrees = 15.0 * (k % 7)};
    const Pair y = {stream.uniform(-1, 1), stream.uniform(-1, 1)};
    Pair x = {stream.uniform(-10, 10), stream.uniform(-10, 10)};
    if (k % 3 != 0) {  // where the line already fits, the sine alone decides
      const double angle = options.degrees * M_PI / 180;
      const double w = y[1] / (options.gamma * options.xi);
      x = {std::cos(angle) * x[0] + std::sin(angle) * w,
           -std::sin(angle) * x[0] + std::cos(angle) * w};
    }
    const AnyProblem<double> problem(problems::sine_plane(options));
    const Batch<double> at = Eigen::Vector2d(x[0], x[1]),
                        target = Eigen::Vector2d(y[0], y[1]), none(0, 1);
    Batch<double> seen(2, 1), g(2, 1), h(4, 1);
    Workspace work;
    Tape tape;
    problem.linearize(at, none, seen, tape);
    problem.pullback(tape, seen - target, g, work);
    const Pair dx = limited_newton_step(options, x, y);
    ASSERT_TRUE(std::isfinite(dx[0]) && std::isfinite(dx[1]));
    EXPECT_LE(dx[0] * g(0) + dx[1] * g(1), 1e-9 * g.squaredNorm());
    problem.hessian(at, none, target, h, work);
    const Vector<double> plain =
        newton_step({.flip = false},
                    g.col(0),
                    Eigen::Map<const Batch<double>>(h.data(), 2, 2));
    uphill += plain.dot(g.col(0)) > 0;
  }
  EXPECT_GT(uphill, 1000);  // which is what the flip is for
}

TEST(SinePlane, NothingIsNaNWhereQuotientsAre) {
  const SinePlaneOptions options;
  const double quarter = M_PI / 20;  // u_1 = pi / 2: the sine is flat
  EXPECT_EQ(limited_newton_step(options, {0, 0}, {0, 0}), (Pair{0, 0}));
  for (const double y : {1.0, -1.0, 0.0}) {
    const Pair dx = limited_newton_step(options, {quarter, 0}, {y, 0});
    EXPECT_TRUE(std::isfinite(dx[0]) && std::isfinite(dx[1]));
  }
  EXPECT_TRUE(
      std::isnan(limited_newton_step(options, {std::nan(""), 0}, {0, 0})[0]));
  const Pair there = nearest_solution(options, {0, 0}, {1 + 1e-15, 0});
  EXPECT_NEAR(there[0], quarter, 1e-12);
}

// The range of solutions scales with xi, whatever the turn.
TEST(SinePlane, SolutionsStretchWithXi) {
  const auto extent = [](double xi) {
    const SinePlaneOptions options{.xi = xi, .degrees = 30};
    double most = 0;
    for (int k = 0; k <= 40; ++k) {
      const Pair x = nearest_solution(options, {0, 0}, {-1 + k / 20.0, 0.5});
      most = std::max(most, std::hypot(x[0], x[1]));
    }
    return most / xi;
  };
  for (const double xi : {3.0, 10.0, 64.0})
    EXPECT_NEAR(extent(xi), extent(32), 0.2 * extent(32));
}

}  // namespace
}  // namespace physinv::test
