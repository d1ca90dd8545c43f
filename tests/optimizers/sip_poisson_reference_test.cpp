// The vectors of sip-poisson: the problem, and training through the stage on
// the listed batch from the listed weights. Second derivatives and the Fourier
// neural operator have tests of their own.
#include <array>
#include <stdexcept>
#include <string>

#include "optimizers/training.h"
#include "optimizers/training/proxy.h"
#include "problems/poisson/poisson.h"
#include "suite/nn/unet.h"
#include "tests/support/listed.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kPoissonId = "sip-poisson";

Comparator poisson_tolerance(const Json& entry, Precision precision) {
  const Comparator exact = EntryTolerance(entry.at("tolerance")).array();
  if (precision == Precision::f64) return exact;
  return {5e-3, std::max(exact.atol(), 1e-4)};
}

void check_spectrum(const Json& entry) {
  const Json grids = entry.at("inputs").at("grids");
  const Json values = entry.at("expected").at("values");
  ASSERT_EQ(grids.size(), values.size());
  for (std::size_t g = 0; g < grids.size(); ++g) {
    const Batch<double> lambda = poisson_eigenvalues(grids[g][0], grids[g][1]);
    const auto size = -lambda.array();
    const double squared = 1 / std::pow(size.minCoeff(), 2);
    const Vector<double> found =
        Eigen::Vector4d(size.minCoeff(), size.maxCoeff(), squared, 2 / squared);
    EXPECT_TRUE(
        poisson_tolerance(entry, Precision::f64)(found, vector(values[g])));
  }
}

template <class T>
void check_small(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const auto same = poisson_tolerance(
      entry, std::is_same_v<T, double> ? Precision::f64 : Precision::f32);
  const auto p = Index(in.at("x").size()), q = Index(in.at("x").front().size());
  const Batch<T> x = field(in.at("x")).cast<T>(),
                 truth = field(in.at("x_star"), p, q).cast<T>(), none(0, 1);
  const AnyProblem<T> problem(problems::poisson({.rows = p, .columns = q}));
  Batch<T> y(x), target(x), y_bar(x), gradient(x), found(x);
  Vector<double> loss(1);
  Workspace work;
  Tape tape;
  problem.forward(truth, none, target, work);
  problem.linearize(x, none, y, tape);
  problem.loss(y, target, loss);
  problem.loss_gradient(y, target, y_bar);
  problem.pullback(tape, y_bar, gradient, work);
  const auto expect = [&](const Batch<T>& got, const char* key) {
    EXPECT_TRUE(
        same(Batch<double>(got.template cast<double>()), field(want.at(key))))
        << key;
  };
  expect(y, "y");
  expect(target, "y_star");
  expect(gradient, "gradient");
  EXPECT_TRUE(same(loss(0), number(want.at("loss"))));
  problem.invert(target, none, x, found, work);
  expect(found - x, "step_sip");
  problem.invert(x, none, x, found, work);  // the stencil on x itself
  expect(found, "laplace_of_x");
}

template <class T>
void check_large(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const bool exact = std::is_same_v<T, double>;
  const auto same =
      poisson_tolerance(entry, exact ? Precision::f64 : Precision::f32);
  const Recurrence u(in);
  expect_formula(in, "u", "2*((a k^2+b k+c) mod m)/(m-1)-1");
  const Index p = in.at("grid")[0], q = in.at("grid")[1];
  ASSERT_TRUE(p > 0 && q > 0) << in.at("grid");
  const Batch<T> x = Batch<T>::NullaryExpr(
      p * q, 1, [&](Index k, Index) { return static_cast<T>(u(k)); });
  const Batch<T> none(0, 1);
  const AnyProblem<T> problem(problems::poisson({.rows = p, .columns = q}));
  Batch<T> y(x), gradient(x);
  Workspace work;
  Tape tape;
  problem.linearize(x, none, y, tape);
  problem.pullback(tape, y, gradient, work);
  const Batch<double> found = y.template cast<double>();
  const std::vector<std::array<Index, 2>> cells = in.at("cells");
  const Vector<double> values = vector(want.at("values"));
  ASSERT_EQ(cells.size(), std::size_t(values.size()));
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const auto [i, j] = cells[k];
    ASSERT_TRUE(0 <= i && i < p && 0 <= j && j < q) << in.at("cells")[k];
    EXPECT_TRUE(same(found(i * q + j), values(Index(k))));
  }
  EXPECT_TRUE(same(found.sum(), number(want.at("sum"))));
  EXPECT_TRUE(same(found.norm(), number(want.at("norm"))));
  EXPECT_TRUE(same(gradient.template cast<double>().norm(),
                   number(want.at("gradient_norm"))));
}

/// The problem's own scale and smoothness are those of the specification.
void check_noise(const Json& entry) {
  const Json in = entry.at("inputs");
  ASSERT_EQ(number(in.at("scale")), 10) << "the problem has no other scale";
  ASSERT_EQ(number(in.at("smoothness")), 1)
      << "the problem has no other smoothness";
  const std::array<Index, 2> grid = in.at("grid");
  const Batch<double> re = rows(in.at("re"), grid[0], grid[1]),
                      im = rows(in.at("im"), grid[0], grid[1]);
  EXPECT_TRUE(poisson_tolerance(entry, Precision::f64)(
      poisson_source(re, im), rows(entry.at("expected").at("x"))));
}

// ---- training ---------------------------------------------------------------

NetworkRecipe unet_on(Index rows, Index columns) {
  return nn::unet({.grid = {columns, rows},
                   .padding = nn::Padding::circular,
                   .batch_statistics = true});
}

/// The same on every grid.
const std::vector<TensorInfo>& unet_tensors() {
  static const auto net = unet_on(16, 16).make<double>(256, 256);
  return net->tensors();
}

Batch<double> unet_weights(const Json& rule) {
  return recurrence_weights(rule, unet_tensors());
}

/// Fields of one size.
struct Plane {
  explicit Plane(const Json& list)
      : y(fields(list)),
        rows(Index(list.front().size())),
        columns(Index(list.front().front().size())) {}
  Batch<double> y;
  Index rows, columns;
};

/// The entry's own batch, or the one that it names.
Plane listed(const Json& entry) {
  return Plane(batch_of(kPoissonId, entry.at("inputs").at("y_star"), "y"));
}

struct PoissonRun {
  Index updates = 0;
  StepOptions rule = SgdOptions{.rate = 1};
  bool sip = false;
  Precision precision = Precision::f64;
};

Outcome run(const Json& rule, const Plane& plane, const PoissonRun& r) {
  const Index n = plane.y.cols();
  const auto stage = train({.rule = r.rule,
                            .batch = n,
                            .gradient_scale = double(n),
                            .signal = r.sip ? inverse_proxy() : solver_loss()});
  StageBench bench(
      *stage,
      n,
      r.updates,
      with_samples(
          problems::poisson({.rows = plane.rows, .columns = plane.columns}),
          {plane.y, plane.y, Batch<double>(0, plane.y.cols())}),
      {.predictor = {{Field::observations}, unet_on(plane.rows, plane.columns)},
       .surrogate = {}});
  Outcome before;
  before.arrays["parameters"] = unet_weights(rule);
  return bench.run(&before, r.precision);
}

constexpr auto kPrecisions = {Precision::f64, Precision::f32};

void check_unet(const Json& entry) {
  const Json in = entry.at("inputs");
  for (const Precision p : kPrecisions) {
    const auto out = run(in.at("weights"), Plane(in.at("y")), {.precision = p});
    EXPECT_TRUE(poisson_tolerance(entry, p)(
        out.x, fields(entry.at("expected").at("output"))));
  }
}

/// A step of length one is the gradient.
void check_training_gradient(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const std::string method = in.at("method");
  ASSERT_TRUE(method == "l2" || method == "sip")
      << "no test knows the method " << method;
  const Json rule = in.at("weights");
  const Plane plane = listed(entry);
  for (const Precision p : kPrecisions) {
    const auto same = poisson_tolerance(entry, p);
    const Outcome after = run(
        rule, plane, {.updates = 1, .sip = method == "sip", .precision = p});
    EXPECT_TRUE(same(after.arrays.at("batch_loss")(0) * double(after.x.cols()),
                     number(want.at("loss"))));
    const Vector<double> g =
        (unet_weights(rule) - after.arrays.at("parameters")).col(0);
    EXPECT_TRUE(same(tensor_norms(unet_tensors(), g),
                     vector(want.at("gradient_norms"))));
    const auto part = [&](const TensorInfo& t) {
      return Vector<double>(g.segment(t.offset, t.size));
    };
    const auto last = unet_tensors().end();
    EXPECT_TRUE(
        same(part(*(last - 2)), vector(want.at("out_weight_gradient"))));
    EXPECT_TRUE(same(part(*(last - 1)), vector(want.at("out_bias_gradient"))));
  }
}

/// Rates as the description states them.
StepOptions rule_of(const Json& entry) {
  const std::string method = entry.at("inputs").at("method");
  if (method == "sgd")
    return SgdOptions{.rate = setting(entry, "lr", "sgd here uses lr ", 1e-9),
                      .momentum = setting(entry, "momentum", "momentum ", 0.9)};
  if (method == "adam" || method == "sip")
    return AdamOptions{.rate = setting(entry, "lr", "Adam (?:lr )?", 1e-3),
                       .eps = 1e-8};
  throw std::runtime_error("no test knows the method " + method);
}

/// After every step: sum, norm and first entries of the output.
void check_steps(const Json& entry) {
  const Json in = entry.at("inputs");
  const Batch<double> after = columns(entry.at("expected").at("after_step"));
  const Plane plane = listed(entry);
  const Index first = after.rows() - 2;
  ASSERT_TRUE(1 <= first && first <= plane.y.rows());
  for (const Precision p : kPrecisions) {
    for (Index k = 1; k <= after.cols(); ++k) {
      const Outcome out = run(in.at("weights"),
                              plane,
                              {.updates = k,
                               .rule = rule_of(entry),
                               .sip = in.at("method") == "sip",
                               .precision = p});
      Vector<double> seen(after.rows());
      seen << out.x.sum(), out.x.norm(), out.x.col(0).head(first);
      EXPECT_TRUE(poisson_tolerance(entry, p)(seen, after.col(k - 1))) << k;
    }
  }
}

TEST(SipPoissonReference, ProblemAndTraining) {
  check_entries(
      kPoissonId,
      {{"spectrum", check_spectrum},
       {"solve-small", in_both(check_small<float>, check_small<double>)},
       {"solve-large", in_both(check_large<float>, check_large<double>)},
       {"noise", check_noise},
       {"unet-forward-*", check_unet},
       {"training-gradient-*", check_training_gradient},
       {"three-steps-*", check_steps}},
      {"hessian-vector",
       "adahessian-*",
       "ggn-vector",
       "hessian-free-*",
       "fno"});
}

// As the authors' float code: error of y, relative to its largest value.
TEST(Poisson, ConjugateGradientsComeToTheExactSolution) {
  for (const Index columns : {32, 60}) {
    const AnyProblem<double> exact(
        problems::poisson({.rows = 32, .columns = columns}));
    const AnyProblem<double> iterated(
        problems::poisson({.rows = 32, .columns = columns, .relative = 1e-5}));
    const auto drawn = exact.sample(0, 3, Rng::root("poisson", 0));
    Batch<double> y(drawn.y);
    Workspace work;
    iterated.forward(drawn.x, drawn.given, y, work);
    const double error = (y - drawn.y).cwiseAbs().maxCoeff();
    EXPECT_LT(error, 2e-5 * drawn.y.cwiseAbs().maxCoeff());
    EXPECT_GT(error, 0);
  }
}

TEST(Poisson, SourcesHaveNoMeanAndUnitVariance) {
  const AnyProblem<double> problem(
      problems::poisson({.rows = 20, .columns = 12}));
  const auto drawn = problem.sample(0, 5, Rng::root("poisson", 1));
  for (Index i = 0; i < 5; ++i) {
    EXPECT_NEAR(drawn.x.col(i).mean(), 0, 1e-13);
    EXPECT_NEAR(drawn.x.col(i).squaredNorm() / 240, 1, 1e-12);
  }
  Batch<double> x(drawn.x);
  Workspace work;
  problem.invert(drawn.y, drawn.given, drawn.x, x, work);
  EXPECT_LT((x - drawn.x).cwiseAbs().maxCoeff(), 1e-11);
}

}  // namespace
}  // namespace physinv::test
