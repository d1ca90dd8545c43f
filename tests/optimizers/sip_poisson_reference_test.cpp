// The vectors of sip-poisson: the problem, and training through the stage on
// the listed batch from the listed weights. Second derivatives and the Fourier
// neural operator have tests of their own.
#include "optimizers/training.h"
#include "optimizers/training/proxy.h"
#include "problems/poisson/poisson.h"
#include "suite/nn/unet.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kPoissonId = "sip-poisson";

/// u(k) of an entry.
struct Recurrence {
  explicit Recurrence(const Json& rule)
      : a(rule.at("a")), b(rule.at("b")), c(rule.at("c")), m(rule.at("m")) {}
  double operator()(Index k) const {
    return 2.0 * double((a * k * k + b * k + c) % m) / double(m - 1) - 1;
  }
  Index a, b, c, m;
};

Comparator poisson_tolerance(const Json& entry, Precision precision) {
  const Comparator exact = EntryTolerance(entry.at("tolerance")).array();
  if (precision == Precision::f64) return exact;
  return {5e-3, std::max(exact.atol(), 1e-4)};
}

void expect_keys_of(const Json& entry, const std::set<std::string>& known) {
  std::set<std::string> found;
  for (const auto& [key, value] : entry.at("expected").items())
    found.insert(key);
  EXPECT_EQ(found, known) << entry.at("name");
}

/// A list of rows as it lies in memory.
Batch<double> field_of(const Json& list) {
  return Batch<double>(rows(list).transpose()).reshaped();
}

Batch<double> fields_of(const Json& list) {
  Batch<double> all(field_of(list.front()).rows(), Index(list.size()));
  Index i = 0;
  for (const Json& field : list) all.col(i++) = field_of(field);
  return all;
}

void check_spectrum(const Json& entry) {
  expect_keys_of(entry, {"values"});
  const Json& grids = entry.at("inputs").at("grids");
  for (std::size_t g = 0; g < grids.size(); ++g) {
    const Poisson<double> problem(
        {.rows = grids[g][0], .columns = grids[g][1]});
    const auto size = -problem.eigenvalues().array();
    const double squared = 1 / std::pow(size.minCoeff(), 2);
    const Vector<double> found =
        Eigen::Vector4d(size.minCoeff(), size.maxCoeff(), squared, 2 / squared);
    EXPECT_TRUE(poisson_tolerance(entry, Precision::f64)(
        found, vector(entry.at("expected").at("values")[g])));
  }
}

template <class T>
void check_small_in(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  const auto same = poisson_tolerance(
      entry, std::is_same_v<T, double> ? Precision::f64 : Precision::f32);
  const Batch<T> x = field_of(in.at("x")).cast<T>(),
                 truth = field_of(in.at("x_star")).cast<T>(), none(0, 1);
  const Poisson<T> problem({.rows = Index(in.at("x").size()),
                            .columns = Index(in.at("x").front().size())});
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
    EXPECT_TRUE(same(Batch<double>(got.template cast<double>()),
                     field_of(want.at(key))))
        << key;
  };
  expect(y, "y");
  expect(target, "y_star");
  expect(gradient, "gradient");
  EXPECT_TRUE(same(loss(0), want.at("loss").get<double>()));
  problem.invert(target, none, x, found, work);
  expect(found - x, "step_sip");
  problem.invert(x, none, x, found, work);  // the stencil on x itself
  expect(found, "laplace_of_x");
}

void check_small(const Json& entry) {
  expect_keys_of(
      entry, {"y", "y_star", "loss", "gradient", "step_sip", "laplace_of_x"});
  check_small_in<double>(entry);
  check_small_in<float>(entry);
}

template <class T>
void check_large_in(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  const bool exact = std::is_same_v<T, double>;
  const auto same =
      poisson_tolerance(entry, exact ? Precision::f64 : Precision::f32);
  const Recurrence u(in);
  const Index p = in.at("grid")[0], q = in.at("grid")[1];
  const Batch<T> x = Batch<T>::NullaryExpr(
      p * q, 1, [&](Index k, Index) { return static_cast<T>(u(k)); });
  const Batch<T> none(0, 1);
  const Poisson<T> problem({.rows = p, .columns = q});
  Batch<T> y(x), gradient(x);
  Workspace work;
  Tape tape;
  problem.linearize(x, none, y, tape);
  problem.pullback(tape, y, gradient, work);
  const Batch<double> found = y.template cast<double>();
  Index k = 0;
  for (const Json& cell : in.at("cells"))
    EXPECT_TRUE(same(found(cell[0].get<Index>() * q + cell[1].get<Index>()),
                     want.at("values")[std::size_t(k++)].get<double>()));
  EXPECT_TRUE(same(found.sum(), want.at("sum").get<double>()));
  EXPECT_TRUE(same(found.norm(), want.at("norm").get<double>()));
  EXPECT_TRUE(same(gradient.template cast<double>().norm(),
                   want.at("gradient_norm").get<double>()));
}

void check_large(const Json& entry) {
  expect_keys_of(entry, {"values", "sum", "norm", "gradient_norm"});
  check_large_in<double>(entry);
  check_large_in<float>(entry);
}

void check_noise(const Json& entry) {
  const Json& in = entry.at("inputs");
  expect_keys_of(entry, {"x"});
  EXPECT_EQ(in.at("scale"), 10);
  EXPECT_EQ(in.at("smoothness"), 1);
  EXPECT_TRUE(poisson_tolerance(entry, Precision::f64)(
      poisson_source(rows(in.at("re")), rows(in.at("im"))),
      rows(entry.at("expected").at("x"))));
}

// ---- training ---------------------------------------------------------------

struct ListedOfPoissonOptions {
  Batch<double> y;
  Index rows = 16, columns = 16;
};
Options describe(const ListedOfPoissonOptions&) { return {}; }

template <class T>
class ListedOfPoisson final : public Poisson<T> {
 public:
  using Options = ListedOfPoissonOptions;
  explicit ListedOfPoisson(const Options& o = {})
      : Poisson<T>({.rows = o.rows, .columns = o.columns}), y_(o.y) {}
  Samples<double> sample(Index first, Index count, const Rng&) const override {
    const Batch<double> y = y_.middleCols(first, count);
    return {y, y, Batch<double>(0, count)};
  }

 private:
  Batch<double> y_;
};

NetworkRecipe unet_on(Index rows, Index columns) {
  return nn::unet({.grid = {columns, rows},
                   .padding = nn::Padding::circular,
                   .batch_statistics = true});
}

const std::vector<TensorInfo>& unet_tensors() {
  static const auto net = unet_on(16, 16).make<double>(256, 256);
  return net->tensors();
}

Batch<double> unet_weights(const Json& rule) {
  const Recurrence u(rule);
  Batch<double> w(37'697, 1);
  for (const TensorInfo& t : unet_tensors())
    for (Index k = t.offset; k < t.offset + t.size; ++k)
      w(k) = t.kind == 's'   ? 1 + 0.1 * u(k)
             : t.kind == 'o' ? 0.1 * u(k)
                             : u(k) / std::sqrt(double(t.fan_in));
  return w;
}

struct PoissonRun {
  Batch<double> y;
  Index rows = 16, columns = 16, updates = 0;
  StepOptions rule = SgdOptions{.rate = 1};
  bool sip = false;
  Precision precision = Precision::f64;
};

Outcome run(const Json& rule, const PoissonRun& r) {
  const Index n = r.y.cols();
  const auto stage = train({.rule = r.rule,
                            .batch = n,
                            .gradient_scale = double(n),
                            .signal = r.sip ? inverse_proxy() : solver_loss()});
  StageBench bench(
      *stage,
      n,
      r.updates,
      problem<ListedOfPoisson>("poisson", {r.y, r.rows, r.columns}),
      {.predictor = {{Field::observations}, unet_on(r.rows, r.columns)},
       .surrogate = {}});
  Outcome before;
  before.arrays["parameters"] = unet_weights(rule);
  return bench.run(&before, r.precision);
}

constexpr auto kPrecisions = {Precision::f64, Precision::f32};

void check_unet(const Json& entry) {
  expect_keys_of(entry, {"output"});
  const Json& in = entry.at("inputs");
  const Json& first = in.at("y").front();
  for (const Precision p : kPrecisions) {
    const auto out = run(in.at("weights"),
                         {.y = fields_of(in.at("y")),
                          .rows = Index(first.size()),
                          .columns = Index(first.front().size()),
                          .precision = p});
    EXPECT_TRUE(poisson_tolerance(entry, p)(
        out.x, fields_of(entry.at("expected").at("output"))));
  }
}

Batch<double> listed_y() {
  const Json entry = reference_entries(kPoissonId, "unet-forward-16x16")[0];
  return fields_of(entry.at("inputs").at("y"));
}

/// A step of length one is the gradient.
void check_training_gradient(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  expect_keys_of(
      entry,
      {"loss", "gradient_norms", "out_weight_gradient", "out_bias_gradient"});
  const Json& rule = in.at("weights");
  for (const Precision p : kPrecisions) {
    const auto same = poisson_tolerance(entry, p);
    const Outcome after = run(rule,
                              {.y = listed_y(),
                               .updates = 1,
                               .sip = in.at("method") == "sip",
                               .precision = p});
    EXPECT_TRUE(same(after.arrays.at("batch_loss")(0) * double(after.x.cols()),
                     want.at("loss").get<double>()));
    const Vector<double> g =
        (unet_weights(rule) - after.arrays.at("parameters")).col(0);
    Vector<double> norms(Index(unet_tensors().size()));
    Index t = 0;
    for (const TensorInfo& tensor : unet_tensors())
      norms(t++) = g.segment(tensor.offset, tensor.size).norm();
    EXPECT_TRUE(same(norms, vector(want.at("gradient_norms"))));
    EXPECT_TRUE(same(Vector<double>(g.segment(g.size() - 17, 16)),
                     vector(want.at("out_weight_gradient"))));
    EXPECT_TRUE(
        same(Vector<double>(g.tail(1)), vector(want.at("out_bias_gradient"))));
  }
}

void check_three_steps(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  expect_keys_of(entry, {"after_step"});
  const std::string method = in.at("method");
  StepOptions rule = AdamOptions{.rate = 1e-3, .eps = 1e-8};
  if (method == "sgd") rule = SgdOptions{.rate = 1e-9, .momentum = 0.9};
  for (const Precision p : kPrecisions) {
    for (Index k = 1; k <= 3; ++k) {
      const Outcome out = run(in.at("weights"),
                              {.y = listed_y(),
                               .updates = k,
                               .rule = rule,
                               .sip = method == "sip",
                               .precision = p});
      Vector<double> seen(8);
      seen << out.x.sum(), out.x.norm(), out.x.col(0).head(6);
      EXPECT_TRUE(poisson_tolerance(entry, p)(
          seen, vector(want.at("after_step")[std::size_t(k - 1)])))
          << method << ' ' << k;
    }
  }
}

TEST(SipPoissonReference, ProblemAndTraining) {
  check_entries(kPoissonId,
                {{"spectrum", check_spectrum},
                 {"solve-small", check_small},
                 {"solve-large", check_large},
                 {"noise", check_noise},
                 {"unet-forward-16x16", check_unet},
                 {"unet-forward-20x15", check_unet},
                 {"training-gradient-l2", check_training_gradient},
                 {"training-gradient-sip", check_training_gradient},
                 {"three-steps-sgd", check_three_steps},
                 {"three-steps-adam", check_three_steps},
                 {"three-steps-sip", check_three_steps}},
                {"hessian-vector",
                 "adahessian-two-steps",
                 "ggn-vector",
                 "hessian-free-two-steps",
                 "fno"});
}

// As the authors' float code: error of y, relative to its largest value.
TEST(Poisson, ConjugateGradientsComeToTheExactSolution) {
  for (const Index columns : {32, 60}) {
    const Poisson<double> exact({.rows = 32, .columns = columns});
    const Poisson<double> iterated(
        {.rows = 32, .columns = columns, .relative = 1e-5});
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
  const Poisson<double> problem({.rows = 20, .columns = 12});
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
