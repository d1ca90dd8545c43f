// The vectors of sip-sine: the problem itself, and training through the stage
// on listed samples from listed weights.
#include "optimizers/training.h"
#include "optimizers/training/newton.h"
#include "optimizers/training/proxy.h"
#include "problems/sine_plane/sine_plane.h"
#include "suite/nn/mlp.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kId = "sip-sine";
constexpr auto kBoth = {Precision::f64, Precision::f32};

struct ListedSineOptions {
  std::vector<Pair> y;
  SinePlaneOptions sine;
};
Options describe(const ListedSineOptions&) { return {}; }

/// The sine on a list of observations, whatever set is asked for.
template <class T>
class ListedSine final : public SinePlane<T> {
 public:
  using Options = ListedSineOptions;
  explicit ListedSine(const Options& options = {})
      : SinePlane<T>(options.sine), y_(options.y) {}

  Samples<double> sample(Index first, Index count, const Rng&) const override {
    Samples<double> s{
        Batch<double>::Zero(2, count), Batch<double>(2, count), {}};
    s.given.resize(0, count);
    for (Index i = 0; i < count; ++i) {
      const Pair& y = y_.at(static_cast<std::size_t>(first + i));
      s.y.col(i) << y[0], y[1];
    }
    return s;
  }

 private:
  std::vector<Pair> y_;
};

Setting sine_setting() {
  return {
      .predictor = {{Field::observations}, nn::mlp({.hidden = {32, 64, 32}})},
      .surrogate = {}};
}

Batch<double> sine_weights(const Json& rule) {
  const auto at = [&](const char* key) { return rule.at(key).get<Index>(); };
  const std::vector<Index> sizes = {2, 32, 64, 32, 2};
  Batch<double> all(4354, 1);
  Index k = 0;
  for (std::size_t l = 0; l + 1 < sizes.size(); ++l) {
    const double bound =
        rule.at("s").get<double>() / std::sqrt(static_cast<double>(sizes[l]));
    for (Index n = sizes[l + 1] * (sizes[l] + 1); n > 0; --n, ++k) {
      const Index u = (at("a") * k * k + at("b") * k + at("c")) % at("m");
      all(k) = (2.0 * double(u) / double(at("m") - 1) - 1) * bound;
    }
  }
  EXPECT_EQ(k, 4354);
  return all;
}

/// In single precision the network's own rounding is stretched by b = 320.
Comparator tolerance_of(const Json& entry, Precision precision) {
  const Json& t = entry.at("tolerance");
  const double rtol = t.at("rtol"), atol = t.at("atol");
  return precision == Precision::f64 ? Comparator(rtol, atol)
                                     : Comparator(1e-4, std::max(atol, 1e-6));
}

void expect_only(const Json& expected, const std::set<std::string>& known) {
  for (const auto& [key, value] : expected.items())
    EXPECT_TRUE(known.contains(key)) << "nobody reads " << key;
}

SinePlaneOptions options_of(const Json& in) {
  return {.gamma = in.value("gamma", 10.0),
          .xi = in.at("xi"),
          .degrees = in.at("phi_degrees")};
}

std::vector<Pair> pairs(const Json& list) { return list; }

template <class T>
void check_point_in(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  const SinePlaneOptions options = options_of(in);
  const auto same = std::is_same_v<T, double>
                        ? tolerance_of(entry, Precision::f64)
                        : Comparator(3e-3, 1e-5);  // u is up to 640 here
  const SinePlane<T> problem(options);
  const Batch<T> x = vector(in.at("x")).cast<T>(),
                 target = vector(in.at("y_target")).cast<T>(), given(0, 1);
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
    const Json& value = want.at(key);
    const Batch<double> wanted =
        value.is_number() ? Batch<double>::Constant(1, 1, value)
        : value.front().is_array()
            ? Batch<double>(Eigen::Map<const Batch<double>>(
                  rows(value).eval().data(), 4, 1))
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
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  expect_only(want,
              {"y",
               "loss",
               "gradient",
               "hessian",
               "eigenvalues",
               "step_unlimited",
               "step_limited",
               "closest",
               "distance"});
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
                   want.at("distance").get<double>()));
  expect(limited_newton_step(options, x, target), "step_limited");
  options.limit = 1e300;
  expect(limited_newton_step(options, x, target), "step_unlimited");
  // The eigenvalues in the turned frame are those of the Hessian without a
  // turn.
  const Vector<double> eigenvalues = vector(want.at("eigenvalues"));
  const double c = std::cos(options.degrees * M_PI / 180),
               s = std::sin(options.degrees * M_PI / 180);
  const Batch<double> w{{c * x[0] - s * x[1]}, {s * x[0] + c * x[1]}};
  options.degrees = 0;
  Batch<double> straight(4, 1);
  Workspace work;
  SinePlane<double>(options).hessian(w,
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
                   problem<ListedSine>("sine_plane", {r.samples, r.problem}),
                   sine_setting());
  Outcome before;
  before.arrays["parameters"] = sine_weights(rule);
  before.arrays["state"] = Batch<double>(0, 1);
  return bench.run(&before, r.precision);
}

void check_network(const Json& entry) {
  const Json& in = entry.at("inputs");
  expect_only(entry.at("expected"), {"x"});
  for (const Precision p : kBoth) {
    const auto out = run(in.at("weights"),
                         {.samples = pairs(in.at("y")),
                          .batch = 6,
                          .updates = 0,
                          .precision = p});
    EXPECT_TRUE(
        tolerance_of(entry, p)(out.x, columns(entry.at("expected").at("x"))));
  }
}

SignalRecipe signal_of(const std::string& method, const std::string& loss) {
  if (method != "sip") return solver_loss();
  return inverse_proxy(loss == "l1" ? ProxyNorm::absolute : ProxyNorm::square);
}

/// A step of length one is the gradient.
void check_gradient(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  expect_only(want,
              {"adjoint", "gradient_norm", "gradient_first", "gradient_last"});
  const std::string method = in.at("method"), loss = in.at("sip_loss");
  const auto samples = pairs(in.at("y"));
  const auto count = static_cast<Index>(samples.size());
  const SinePlaneOptions options = options_of(in);
  for (const Precision p : kBoth) {
    // Sums of single precision cancel: relative to the largest of them.
    const auto same =
        p == Precision::f64
            ? tolerance_of(entry, p)
            : Comparator(1e-3, 1e-4 * want.at("gradient_norm").get<double>());
    const auto out = run(in.at("weights"),
                         {.problem = options,
                          .samples = samples,
                          .batch = count,
                          .updates = 1,
                          .signal = signal_of(method, loss),
                          .precision = p});
    const Vector<double> step =
        (sine_weights(in.at("weights")) - out.arrays.at("parameters")).col(0);
    EXPECT_TRUE(same(step.norm(), want.at("gradient_norm").get<double>()));
    EXPECT_TRUE(
        same(Vector<double>(step.head(70)), vector(want.at("gradient_first"))));
    EXPECT_TRUE(
        same(Vector<double>(step.tail(70)), vector(want.at("gradient_last"))));
  }
  // The adjoints, from the first estimates.
  const Batch<double> x = run(in.at("weights"),
                              {.problem = options,
                               .samples = samples,
                               .batch = count,
                               .updates = 0})
                              .x;
  const SinePlane<double> problem(options);
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

void check_steps(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  expect_only(want, {"outputs_after_step", "parameter_norm"});
  const std::string name = entry.at("name");
  const std::string method = name.substr(std::string("three-steps-").size());
  const SinePlaneOptions options = options_of(in);
  const std::map<std::string, StepOptions> rules = {
      {"sgd", SgdOptions{.rate = 1e-2 / (options.xi * options.xi)}},
      {"adam", AdamOptions{.rate = 1e-3, .eps = 1e-8}},
      {"sip-l1", AdamOptions{.rate = 1e-3, .eps = 1e-8}},
      {"sip-l2", AdamOptions{.rate = 1e-3, .eps = 1e-8}},
      {"adadelta", AdadeltaOptions{.rate = 3e-3, .decay = 0.9, .eps = 1e-6}},
      {"adagrad", AdagradOptions{.rate = 3e-3, .accumulator = 0, .eps = 1e-10}},
      {"rmsprop", RmspropOptions{.rate = 3e-5, .decay = 0.99, .eps = 1e-8}}};
  auto samples = pairs(in.at("batch_1"));
  const auto batch = static_cast<Index>(samples.size());
  for (const Pair& y : pairs(in.at("batch_2"))) samples.push_back(y);
  for (const Precision p : kBoth) {
    const auto same = tolerance_of(entry, p);
    for (Index k = 1; k <= 3; ++k) {
      const auto out =
          run(in.at("weights"),
              {.problem = options,
               .samples = samples,
               .batch = batch,
               .updates = k,
               .rule = rules.at(method),
               .signal = signal_of(method.starts_with("sip") ? "sip" : method,
                                   method.ends_with("l1") ? "l1" : "l2"),
               .precision = p});
      EXPECT_TRUE(same(
          Batch<double>(out.x.leftCols(batch)),
          columns(
              want.at("outputs_after_step").at(static_cast<size_t>(k - 1)))))
          << name << ' ' << k;
      if (k < 3) continue;
      EXPECT_TRUE(same(out.arrays.at("parameters").norm(),
                       want.at("parameter_norm").get<double>()))
          << name;
    }
  }
}

TEST(SipSineReference, AllEntries) {
  std::map<std::string, std::function<void(const Json&)>> checks;
  for (int i = 0; i < 7; ++i)
    checks["point-" + std::to_string(i)] = check_point;
  checks["network-forward"] = check_network;
  for (const char* m : {"grad-l2", "sip-l1", "sip-l2"})
    checks[std::string("training-gradient-") + m] = check_gradient;
  for (const char* m :
       {"sgd", "adam", "adadelta", "adagrad", "rmsprop", "sip-l1", "sip-l2"})
    checks[std::string("three-steps-") + m] = check_steps;
  check_entries(kId, {checks.begin(), checks.end()});
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
    const SinePlane<double> problem(options);
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
