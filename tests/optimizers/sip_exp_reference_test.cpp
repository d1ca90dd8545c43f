// The vectors of sip-exp: training through the stage itself, on listed samples
// and from listed weights.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "optimizers/training.h"
#include "optimizers/training/newton.h"
#include "optimizers/training/proxy.h"
#include "problems/exponential/exponential.h"
#include "suite/core/math.h"
#include "suite/nn/mlp.h"
#include "tests/support/listed.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kId = "sip-exp";

/// The exponential on a list of unknowns.
ProblemRecipe listed_exponential(const std::vector<double>& x_star) {
  const auto n = static_cast<Index>(x_star.size());
  const Batch<double> x = Eigen::Map<const Batch<double>>(x_star.data(), 1, n);
  return with_samples(problems::exponential(),
                      {x,
                       x.unaryExpr([](double v) { return std::exp(v); }),
                       Batch<double>(0, n)});
}

Setting setting_of_network() {
  const auto net =
      nn::mlp({.hidden = {16, 64, 16}, .activation = nn::Activation::sigmoid});
  return {.predictor = {{Field::observations}, net}, .surrogate = {}};
}

/// Of the network on one number.
const std::vector<TensorInfo>& tensors() {
  static const auto net =
      setting_of_network().predictor.recipe.make<double>(1, 1);
  return net->tensors();
}

Batch<double> weights(const Json& rule) {
  return recurrence_weights(rule, tensors());
}

/// Single precision has its own rounding to lose.
Comparator tolerance(const Json& entry, Precision precision = Precision::f64) {
  const Comparator exact = EntryTolerance(entry.at("tolerance")).array();
  return precision == Precision::f64 ? exact : Comparator(2e-4, exact.atol());
}

struct Run {
  std::vector<double> samples;
  Index batch, updates;
  StepOptions rule;
  bool normalised;
  Precision precision = Precision::f64;
};

Outcome run(const Json& rule, const Run& r) {
  const auto stage =
      train({.rule = r.rule,
             .batch = r.batch,
             .gradient_scale = double(r.batch),
             .signal = r.normalised ? inverse_proxy(ProxyNorm::absolute)
                                    : solver_loss()});
  StageBench bench(*stage,
                   static_cast<Index>(r.samples.size()),
                   r.updates,
                   listed_exponential(r.samples),
                   setting_of_network());
  Outcome before;
  before.arrays["parameters"] = weights(rule);
  before.arrays["state"] = Batch<double>(0, 1);
  return bench.run(&before, r.precision);
}

constexpr auto kBoth = {Precision::f64, Precision::f32};

bool is_normalised(const Json& method) {
  if (method == "norm") return true;
  if (method == "l2") return false;
  throw std::runtime_error(method.path() + " is " + method.dump() +
                           ", the test knows l2 and norm");
}

void check_weights(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const Vector<double> all = weights(in.at("weights"));
  EXPECT_EQ(all.size(), in.at("count").get<Index>());
  const auto same = tolerance(entry);
  const Vector<double> first = vector(want.at("first5")),
                       last = vector(want.at("last5"));
  ASSERT_LE(std::max(first.size(), last.size()), all.size());
  EXPECT_TRUE(same(all.head(first.size()), first));
  EXPECT_TRUE(same(all.tail(last.size()), last));
  EXPECT_TRUE(same(all.norm(), number(want.at("norm"))));
}

/// What pushes x: through the physics, by signs, by distances.
template <class T>
struct Adjoints {
  Adjoints(const Batch<T>& x, const Batch<T>& y) {
    const AnyProblem<T> problem(problems::exponential());
    Workspace work;
    Tape tape;
    const Batch<T> given(0, x.cols());
    Batch<T> seen(y), y_bar(y);
    l2.resizeLike(x), gt.resizeLike(x), loss.resize(x.cols());
    problem.linearize(x, given, seen, tape);
    problem.loss(seen, y, loss);
    problem.loss_gradient(seen, y, y_bar);
    problem.pullback(tape, y_bar, l2, work);
    problem.invert(y, given, x, gt, work);
    gt = x - gt;
    norm = gt.array().sign();
    direct = (seen - y).array().sign();
  }
  Batch<T> l2, norm, gt, direct;
  Vector<double> loss;
};

Batch<double> newton_adjoints(const Batch<double>& x,
                              const Batch<double>& y,
                              const Batch<double>& gradient,
                              const NewtonOptions& options) {
  const AnyProblem<double> problem(problems::exponential());
  Workspace work;
  Batch<double> h(x), adjoint(x);
  problem.hessian(x, Batch<double>(0, x.cols()), y, h, work);
  for (Index i = 0; i < x.cols(); ++i)
    adjoint.col(i) = -newton_step(options, gradient.col(i), h.col(i));
  return adjoint;
}

void check_forward(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const std::vector<double> samples = in.at("x_star");
  const auto batch = static_cast<Index>(samples.size());
  ASSERT_GE(batch, 1);
  for (const Precision p : kBoth) {
    const Outcome out =
        run(in.at("weights"), {samples, batch, 0, SgdOptions{}, false, p});
    EXPECT_TRUE(tolerance(entry, p)(out.x.row(0).transpose().eval(),
                                    vector(want.at("x"))));
  }
  const auto same = tolerance(entry);
  const Batch<double> x = vector(want.at("x"), batch).transpose(),
                      y = vector(want.at("y_star"), batch).transpose();
  const Adjoints<double> a(x, y);
  const auto expect = [&](const Batch<double>& got, const char* key) {
    EXPECT_TRUE(same(got, Batch<double>(vector(want.at(key)).transpose())))
        << key;
  };
  expect(vector(in.at("x_star")).array().exp().matrix().transpose(), "y_star");
  EXPECT_TRUE(same(a.loss.sum(), number(want.at("loss_sum"))));
  expect(a.l2, "adjoint_l2");
  expect(a.norm, "adjoint_norm");
  expect(a.gt, "adjoint_gt");
  // Limit and damping of the specification, section 3.
  expect(newton_adjoints(x, y, a.l2, {}), "adjoint_newton");
  expect(newton_adjoints(x, y, a.l2, {.limit = 0.1}), "adjoint_newton_clipped");
  expect(newton_adjoints(x, y, a.l2, {.damping = 0.01}),
         "adjoint_newton_damped");
}

/// A step of length one is the gradient.
void check_gradient(const Json& entry) {
  const Json in = entry.at("inputs");
  const std::vector<double> samples = in.at("x_star");
  const auto batch = static_cast<Index>(samples.size());
  ASSERT_GE(batch, 1);
  const bool normalised = is_normalised(in.at("method"));
  for (const Precision p : kBoth) {
    const Outcome out =
        run(in.at("weights"),
            {samples, batch, 1, SgdOptions{.rate = 1}, normalised, p});
    const Vector<double> step =
        (weights(in.at("weights")) - out.arrays.at("parameters")).col(0);
    EXPECT_TRUE(
        tolerance(entry, p)(step, vector(entry.at("expected").at("gradient"))));
  }
}

/// Momentum and decays are the specification's (section 3).
StepOptions rule_of(const Json& in) {
  const double rate = in.at("lr");
  const std::string name = in.at("optimiser");
  if (name == "sgd") return SgdOptions{.rate = rate};
  if (name == "adam") return AdamOptions{.rate = rate, .eps = 1e-8};
  throw std::runtime_error("no test knows the optimiser " + name);
}

/// First batch, second, first, ...
void check_steps(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  std::vector<double> samples = in.at("batch_1");
  const std::vector<double> second = in.at("batch_2");
  ASSERT_EQ(samples.size(), second.size()) << "one batch size for all";
  const auto batch = static_cast<Index>(samples.size());
  ASSERT_GE(batch, 1);
  samples.insert(samples.end(), second.begin(), second.end());
  const bool normalised = is_normalised(in.at("method"));
  const Batch<double> after = columns(want.at("outputs_after_step"));
  for (const Precision p : kBoth) {
    const auto same = tolerance(entry, p);
    for (Index k = 1; k <= after.cols(); ++k) {
      const Outcome out = run(in.at("weights"),
                              {samples, batch, k, rule_of(in), normalised, p});
      EXPECT_TRUE(same(Vector<double>(out.x.row(0).head(batch).transpose()),
                       after.col(k - 1)));
      if (k < after.cols()) continue;
      const Vector<double> theta = out.arrays.at("parameters").col(0),
                           first = vector(want.at("first5"));
      EXPECT_TRUE(same(theta.norm(), number(want.at("parameter_norm"))));
      ASSERT_LE(first.size(), theta.size());
      EXPECT_TRUE(same(theta.head(first.size()), first));
    }
  }
}

/// One by one: they span more than a hundred orders of magnitude. What is out
/// of the range of float is 0 or infinite there.
template <class T>
void check_extreme(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const Batch<T> x = vector(in.at("x")).transpose().cast<T>();
  const Batch<T> y =
      vector(in.at("x_star")).array().exp().matrix().transpose().cast<T>();
  ASSERT_EQ(x.cols(), y.cols());
  const Adjoints<T> a(x, y);
  const auto same = tolerance(entry);
  const auto expect = [&](const Batch<T>& got, const char* key, double rtol) {
    const Vector<double> stored = vector(want.at(key));
    ASSERT_EQ(got.cols(), stored.size()) << key;
    for (Index i = 0; i < got.cols(); ++i) {
      // The smallest numbers have no digits left.
      const double lost = 4 * std::numeric_limits<T>::denorm_min() *
                          (1 + std::abs(double(y(0, i))));
      EXPECT_TRUE(Comparator(rtol, same.atol() + lost)(
          double(got(0, i)), double(static_cast<T>(stored(i)))))
          << key << " of x = " << x(0, i);
    }
  };
  constexpr bool kSingle = std::is_same_v<T, float>;
  expect(a.l2, "l2", kSingle ? 1e-5 : same.rtol());
  expect(a.norm, "norm", 0);
  expect(a.gt, "gt", kSingle ? 1e-6 : same.rtol());
}

TEST(SipExpReference, AllEntries) {
  check_entries(kId,
                {{"weights", check_weights},
                 {"forward", check_forward},
                 {"parameter-gradient-*", check_gradient},
                 {"three-steps-*", check_steps},
                 {"adjoint-extreme",
                  in_both(check_extreme<float>, check_extreme<double>)}});
}

// The inverse spares the derivative: its signs are those of the slope.
template <class T>
void expect_same_signs() {
  constexpr Index kPairs = 40'000;
  Batch<T> x(1, kPairs), y(1, kPairs);
  for (Index i = 0; i < kPairs; ++i) {
    x(0, i) = T(-13) * T(i % 200) / T(199);
    y(0, i) = math::exp(T(-12) * T(i / 200) / T(199));
  }
  const Adjoints<T> a(x, y);
  EXPECT_EQ((a.norm.array() != a.direct.array()).count(), 0);
}

TEST(SipExp, SignsOfTheDistanceAreThoseOfTheSlope) {
  expect_same_signs<float>();
  expect_same_signs<double>();
}

TEST(Proxy, ASolvedSampleIsNotPushedAndCallsAreCounted) {
  const AnyProblem<float> problem(problems::exponential());
  Workspace work;
  Batch<float> x = Batch<float>::Constant(1, 3, -2.3F), y(1, 3), given(0, 3);
  problem.forward(x, given, y, work);
  Batch<float> found(1, 3);
  problem.invert(y, given, x, found, work);
  EXPECT_TRUE(found == x);

  const auto stage = train({.rule = AdamOptions{.rate = 1e-2},
                            .batch = 4,
                            .signal = inverse_proxy()});
  EXPECT_EQ(stage->needs(), Needs::forward | Needs::inverse);
  StageBench bench(*stage, 8, 5, problems::exponential(), setting_of_network());
  bench.run();
  EXPECT_EQ(bench.oracle.counts()[Counter::inverse], 20U);
  EXPECT_EQ(bench.oracle.counts()[Counter::vjp], 0U);
}

// One input makes few large singular values; the small ones only overfit.
constexpr hig::Power kWellPosed{.kappa = -1, .tau = 1e-2};

// The step of every direction on its own, and the flip of those that go up.
TEST(Newton, StepsAlongEigenvectors) {
  const Batch<double> hessian{{1, 2}, {2, 1}};  // 3 along (1, 1), -1 along
  const double r = std::sqrt(0.5);              // (1, -1)
  const Vector<double> g{{3 * r + r, 3 * r - r}};
  const auto expect = [&](const NewtonOptions& o, double along, double across) {
    const Vector<double> dx = newton_step(o, g, hessian);
    EXPECT_NEAR(r * (dx(0) + dx(1)), along, 1e-14);
    EXPECT_NEAR(r * (dx(0) - dx(1)), across, 1e-14);
  };
  expect({}, -1, -1);
  expect({.flip = false}, -1, 1);
  expect({.limit = 0.5}, -0.5, -0.5);
  expect({.damping = 3}, -0.5, -0.5);
  const Batch<double> flat = Batch<double>::Constant(1, 1, -1);
  EXPECT_EQ(newton_step({.damping = 1}, g.head(1), flat)(0), 0);
  EXPECT_TRUE(newton_step({}, g * std::nan(""), hessian).array().isNaN().all());
}

/// Of 16 examples, after so many updates of a network.
double error_after_60(const Stage& stage) {
  StageBench bench(
      stage, 16, 60, problems::exponential(), setting_of_network());
  const Outcome out = bench.run();
  return (out.x - bench.oracle.data().x).cwiseAbs().mean();
}

TEST(Newton, TrainsANetwork) {
  const auto error = [&](double rate) {
    const auto stage = train({.rule = AdamOptions{.rate = rate},
                              .batch = 16,
                              .signal = newton_proxy({.limit = 0.1})});
    EXPECT_EQ(stage->needs(), Needs::forward | Needs::vjp | Needs::hessian);
    return error_after_60(*stage);
  };
  EXPECT_LT(error(1e-2), 0.9 * error(0));
}

// Rules that ask for Jacobians take the proxy as a solver that hands x on.
TEST(Proxy, DrivesEveryRule) {
  for (const ProxyNorm norm : {ProxyNorm::square, ProxyNorm::absolute}) {
    SCOPED_TRACE(static_cast<int>(norm));
    const auto error = [&](auto rule) {
      return error_after_60(
          *train({.rule = rule, .batch = 16, .signal = inverse_proxy(norm)}));
    };
    const double start = error(SgdOptions{.rate = 0});
    EXPECT_LT(error(SgdOptions{.rate = 0.1}), 0.9 * start);
    EXPECT_LT(error(AdamOptions{.rate = 1e-2}), 0.9 * start);
    EXPECT_LT(error(HalfInverseStepOptions{.power = kWellPosed, .rate = 1}),
              0.9 * start);
  }
}

}  // namespace
}  // namespace physinv::test
