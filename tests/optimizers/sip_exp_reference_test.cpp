// The vectors of sip-exp: training through the stage itself, on listed samples
// and from listed weights.
#include "optimizers/training.h"
#include "optimizers/training/newton.h"
#include "optimizers/training/proxy.h"
#include "problems/exponential/exponential.h"
#include "suite/nn/mlp.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kId = "sip-exp";

struct ListedOptions {
  std::vector<double> x;
};
Options describe(const ListedOptions&) { return {}; }

/// The exponential on a list of samples, whatever set is asked for.
template <class T>
class Listed final : public Exponential<T> {
 public:
  using Options = ListedOptions;
  explicit Listed(const Options& options = {}) : x_(options.x) {}

  Samples<double> sample(Index first, Index count, const Rng&) const override {
    Samples<double> s{Batch<double>(1, count), {}, {}};
    s.given.resize(0, count);
    for (Index i = 0; i < count; ++i)
      s.x(0, i) = x_.at(static_cast<std::size_t>(first + i));
    s.y = s.x.unaryExpr([](double v) { return std::exp(v); });
    return s;
  }

 private:
  std::vector<double> x_;
};

Setting setting() {
  const auto net =
      nn::mlp({.hidden = {16, 64, 16}, .activation = nn::Activation::sigmoid});
  return {.predictor = {{Field::observations}, net}, .surrogate = {}};
}

/// Parameters of one layer after the other, weights row-major, then bias.
Batch<double> weights(const Json& rule) {
  const auto at = [&](const char* key) { return rule.at(key).get<Index>(); };
  const std::vector<Index> sizes = {1, 16, 64, 16, 1};
  Batch<double> all(2177, 1);
  Index k = 0;
  for (std::size_t l = 0; l + 1 < sizes.size(); ++l) {
    const double bound =
        rule.at("s").get<double>() / std::sqrt(static_cast<double>(sizes[l]));
    for (Index n = sizes[l + 1] * (sizes[l] + 1); n > 0; --n, ++k) {
      const Index u = (at("a") * k * k + at("b") * k + at("c")) % at("m");
      all(k) = (2.0 * double(u) / double(at("m") - 1) - 1) * bound;
    }
  }
  EXPECT_EQ(k, 2177);
  return all;
}

Comparator tolerance(const Json& entry) {
  const Json& t = entry.at("tolerance");
  return {t.at("rtol").get<double>(), t.at("atol").get<double>()};
}
/// Single precision has its own rounding to lose.
Comparator tolerance(const Json& entry, Precision precision) {
  const Comparator exact = tolerance(entry);
  return precision == Precision::f64 ? exact : Comparator(2e-4, exact.atol());
}

void expect_keys(const Json& expected, const std::set<std::string>& known) {
  for (const auto& [key, value] : expected.items())
    EXPECT_TRUE(known.contains(key)) << "nobody reads " << key;
}

std::vector<double> list(const Json& values) {
  return values.get<std::vector<double>>();
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
                   problem<Listed>("exponential", {r.samples}),
                   setting());
  Outcome before;
  before.arrays["parameters"] = weights(rule);
  before.arrays["state"] = Batch<double>(0, 1);
  return bench.run(&before, r.precision);
}

constexpr auto kBoth = {Precision::f64, Precision::f32};

void check_weights(const Json& entry) {
  const Json& want = entry.at("expected");
  expect_keys(want, {"first5", "last5", "norm"});
  const Vector<double> all = weights(entry.at("inputs").at("weights"));
  EXPECT_EQ(all.size(), entry.at("inputs").at("count").get<Index>());
  const auto same = tolerance(entry);
  EXPECT_TRUE(same(all.head(5), vector(want.at("first5"))));
  EXPECT_TRUE(same(all.tail(5), vector(want.at("last5"))));
  EXPECT_TRUE(same(all.norm(), want.at("norm").get<double>()));
}

/// What pushes x: through the physics, by signs, by distances.
template <class T>
struct Adjoints {
  Adjoints(const Batch<T>& x, const Batch<T>& y) {
    const Exponential<T> problem;
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
  const Exponential<double> problem;
  Workspace work;
  Batch<double> h(x), adjoint(x);
  problem.hessian(x, Batch<double>(0, x.cols()), y, h, work);
  for (Index i = 0; i < x.cols(); ++i)
    adjoint.col(i) = -newton_step(options, gradient.col(i), h.col(i));
  return adjoint;
}

void check_forward(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  expect_keys(want,
              {"x",
               "y_star",
               "loss_sum",
               "adjoint_l2",
               "adjoint_norm",
               "adjoint_gt",
               "adjoint_newton",
               "adjoint_newton_clipped",
               "adjoint_newton_damped"});
  const auto samples = list(in.at("x_star"));
  for (const Precision p : kBoth) {
    const Outcome out =
        run(in.at("weights"), {samples, 8, 0, SgdOptions{}, false, p});
    EXPECT_TRUE(tolerance(entry, p)(out.x.row(0).transpose().eval(),
                                    vector(want.at("x"))));
  }
  const auto same = tolerance(entry);
  const Batch<double> x = vector(want.at("x")).transpose(),
                      y = vector(want.at("y_star")).transpose();
  const Adjoints<double> a(x, y);
  const auto expect = [&](const Batch<double>& got, const char* key) {
    EXPECT_TRUE(same(got, Batch<double>(vector(want.at(key)).transpose())))
        << key;
  };
  expect(vector(in.at("x_star")).array().exp().matrix().transpose(), "y_star");
  EXPECT_TRUE(same(a.loss.sum(), want.at("loss_sum").get<double>()));
  expect(a.l2, "adjoint_l2");
  expect(a.norm, "adjoint_norm");
  expect(a.gt, "adjoint_gt");
  expect(newton_adjoints(x, y, a.l2, {}), "adjoint_newton");
  expect(newton_adjoints(x, y, a.l2, {.limit = 0.1}), "adjoint_newton_clipped");
  expect(newton_adjoints(x, y, a.l2, {.damping = 0.01}),
         "adjoint_newton_damped");
}

/// A step of length one is the gradient.
void check_gradient(const Json& entry) {
  const Json& in = entry.at("inputs");
  expect_keys(entry.at("expected"), {"gradient"});
  for (const Precision p : kBoth) {
    const Outcome out = run(in.at("weights"),
                            {list(in.at("x_star")),
                             8,
                             1,
                             SgdOptions{.rate = 1},
                             in.at("method") == "norm",
                             p});
    const Vector<double> step =
        (weights(in.at("weights")) - out.arrays.at("parameters")).col(0);
    EXPECT_TRUE(
        tolerance(entry, p)(step, vector(entry.at("expected").at("gradient"))));
  }
}

void check_steps(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  expect_keys(want, {"outputs_after_step", "parameter_norm", "first5"});
  auto samples = list(in.at("batch_1"));
  const Index batch = static_cast<Index>(samples.size());
  for (const double x : list(in.at("batch_2"))) samples.push_back(x);
  const double rate = in.at("lr");
  StepOptions rule = AdamOptions{.rate = rate, .eps = 1e-8};
  if (in.at("optimiser") == "sgd") rule = SgdOptions{.rate = rate};
  const bool normalised = in.at("method") == "norm";
  for (const Precision p : kBoth) {
    const auto same = tolerance(entry, p);
    for (Index k = 1; k <= 3; ++k) {
      const Outcome out =
          run(in.at("weights"), {samples, batch, k, rule, normalised, p});
      const auto step = static_cast<std::size_t>(k - 1);
      EXPECT_TRUE(same(Vector<double>(out.x.row(0).head(batch).transpose()),
                       vector(want.at("outputs_after_step").at(step))));
      if (k < 3) continue;
      const Vector<double> theta = out.arrays.at("parameters").col(0);
      EXPECT_TRUE(same(theta.norm(), want.at("parameter_norm").get<double>()));
      EXPECT_TRUE(same(theta.head(5), vector(want.at("first5"))));
    }
  }
}

template <class T>
void check_extreme_in(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  const Batch<T> x = vector(in.at("x")).transpose().cast<T>();
  const Batch<T> y =
      vector(in.at("x_star")).array().exp().matrix().transpose().cast<T>();
  const Adjoints<T> a(x, y);
  const auto row = [&](const char* key) {
    return Batch<T>(vector(want.at(key)).transpose().cast<T>());
  };
  EXPECT_TRUE(a.norm == row("norm"));
  const double rtol = std::is_same_v<T, double> ? 1e-12 : 1e-6;
  EXPECT_TRUE(Comparator(rtol, 0)(a.gt, row("gt")));
  // One by one: they span more than a hundred orders of magnitude.
  for (Index i = 0; i < x.cols(); ++i)
    EXPECT_TRUE(Comparator(rtol * 10 * (std::is_same_v<T, float> ? 1 : 0.1),
                           std::is_same_v<T, float> ? 1e-45 : 0)(
        double(a.l2(0, i)), double(row("l2")(0, i))));
}

void check_extreme(const Json& entry) {
  expect_keys(entry.at("expected"), {"l2", "norm", "gt"});
  check_extreme_in<double>(entry);
  check_extreme_in<float>(entry);
}

TEST(SipExpReference, AllEntries) {
  check_entries(kId,
                {{"weights", check_weights},
                 {"forward", check_forward},
                 {"parameter-gradient-l2", check_gradient},
                 {"parameter-gradient-norm", check_gradient},
                 {"three-steps-sgd-l2", check_steps},
                 {"three-steps-adam-l2", check_steps},
                 {"three-steps-adam-norm", check_steps},
                 {"adjoint-extreme", check_extreme}});
}

// The inverse spares the derivative: its signs are those of the slope.
template <class T>
void expect_same_signs() {
  constexpr Index kPairs = 40'000;
  Batch<T> x(1, kPairs), y(1, kPairs);
  for (Index i = 0; i < kPairs; ++i) {
    x(0, i) = T(-13) * T(i % 200) / T(199);
    y(0, i) = std::exp(T(-12) * T(i / 200) / T(199));
  }
  const Adjoints<T> a(x, y);
  EXPECT_EQ((a.norm.array() != a.direct.array()).count(), 0);
}

TEST(SipExp, SignsOfTheDistanceAreThoseOfTheSlope) {
  expect_same_signs<float>();
  expect_same_signs<double>();
}

TEST(Proxy, ASolvedSampleIsNotPushedAndCallsAreCounted) {
  const Exponential<float> problem;
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
  StageBench bench(
      *stage, 8, 5, physinv::problem<Exponential>("exponential"), setting());
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

TEST(Newton, TrainsANetwork) {
  const auto error = [&](double rate) {
    const auto stage = train({.rule = AdamOptions{.rate = rate},
                              .batch = 16,
                              .signal = newton_proxy({.limit = 0.1})});
    EXPECT_EQ(stage->needs(), Needs::forward | Needs::vjp | Needs::hessian);
    StageBench bench(*stage,
                     16,
                     60,
                     physinv::problem<Exponential>("exponential"),
                     setting());
    const Outcome out = bench.run();
    return (out.x - bench.oracle.data().x).cwiseAbs().mean();
  };
  EXPECT_LT(error(1e-2), 0.9 * error(0));
}

// Rules that ask for Jacobians take the proxy as a solver that hands x on.
TEST(Proxy, DrivesEveryRule) {
  for (const ProxyNorm norm : {ProxyNorm::square, ProxyNorm::absolute}) {
    SCOPED_TRACE(static_cast<int>(norm));
    const auto error = [&](auto rule) {
      const auto stage =
          train({.rule = rule, .batch = 16, .signal = inverse_proxy(norm)});
      StageBench bench(*stage,
                       16,
                       60,
                       physinv::problem<Exponential>("exponential"),
                       setting());
      const Outcome out = bench.run();
      return (out.x - bench.oracle.data().x).cwiseAbs().mean();
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
