// The vectors of sip-poisson that are second derivatives: products, AdaHessian
// and Hessian-free, through signal and rules, on the listed batch and from the
// listed weights.
#include "optimizers/stage.h"
#include "optimizers/training.h"
#include "optimizers/training/adahessian_rule.h"
#include "optimizers/training/batches.h"
#include "optimizers/training/hessian_free_rule.h"
#include "suite/core/linear_problem.h"
#include "suite/nn/unet.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kPoissonId = "sip-poisson";

/// Observations of one size, which are lists of rows.
struct SourcesOptions {
  Batch<double> y;
  Index rows, columns;
};
Options describe(const SourcesOptions&) { return {}; }

/// Of a Laplacian of n cells with zeros at the ends.
struct SineBasis {
  explicit SineBasis(Index n) : sines(n, n), eigenvalues(n) {
    const double turn = M_PI / double(n + 1);
    for (Index k = 0; k < n; ++k) {
      eigenvalues(k) = 2 * std::cos(turn * double(k + 1)) - 2;
      for (Index l = 0; l < n; ++l)
        sines(k, l) = std::sqrt(2.0 / double(n + 1)) *
                      std::sin(turn * double((k + 1) * (l + 1)));
    }
  }
  Batch<double> sines;
  Vector<double> eigenvalues;
};

/// lap y = x with zeros around the cells, solved in the sine basis; on a list
/// of observations, whatever set is asked for.
template <class T>
class ListedPoisson final : public LinearProblem<T> {
 public:
  using Options = SourcesOptions;
  explicit ListedPoisson(const Options& options)
      : y_(options.y),
        rows_(options.rows),
        columns_(options.columns),
        inverse_((rows_.eigenvalues.replicate(1, options.columns).transpose() +
                  columns_.eigenvalues.replicate(1, options.rows))
                     .cwiseInverse()) {}
  Shape shape() const override { return {y_.rows(), y_.rows(), 0}; }
  Vector<double> start() const override {
    return Vector<double>::Zero(y_.rows());
  }
  void draw(Stream&, SampleOut& sample) const override {
    sample.x = sample.y = y_.col(sample.index);
  }
  Drawn drawn() const override { return Drawn::both; }
  void forward(Point<T> at, BatchOut<T> y, Workspace&) const override {
    const auto& x = at.x;
    for (Index i = 0; i < x.cols(); ++i) {
      // A column of the field is a row of cells.
      Batch<double> field = x.col(i).template cast<double>().reshaped(
          columns_.sines.rows(), rows_.sines.rows());
      field = columns_.sines * field * rows_.sines;
      field = columns_.sines * field.cwiseProduct(inverse_) * rows_.sines;
      y.col(i) = field.reshaped().template cast<T>();
    }
  }
  void linearize(Point<T> at, BatchOut<T> y, Tape&) const override {
    Workspace none;
    forward(at, y, none);
  }
  void pullback(const Tape&,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    forward({y_bar, y_bar.topRows(0)}, x_bar, work);
  }
  double operations() const override { return 1; }

 private:
  Batch<double> y_;
  SineBasis rows_, columns_;
  Batch<double> inverse_;
};

Setting plane_setting(const SourcesOptions& plane) {
  const auto net = nn::unet({.grid = {plane.columns, plane.rows},
                             .padding = nn::Padding::circular,
                             .batch_statistics = true});
  return {.predictor = {{Field::observations}, net}, .surrogate = {}};
}

/// Followed by a normalisation, which takes it out again.
bool is_dead(const std::vector<TensorInfo>& all, std::size_t t) {
  return all[t].kind == 'b' && t + 1 < all.size();
}

/// What a test sees of one training in T: on the batch of the first entry, the
/// sum of losses as objective.
template <class T>
struct Place {
  NetworkModel<T>& model;
  Signal<T>& signal;
  const Batch<double>& y;

  const std::vector<TensorInfo>& tensors() const {
    return model.network().tensors();
  }
  Vector<double> norms(const Vector<T>& v) const {
    return tensor_norms(tensors(), v.template cast<double>());
  }
  /// f(k) for every parameter, 0 for the dead ones.
  template <class F>
  Vector<T> direction(F&& f) const {
    Vector<T> v(model.parameters().size());
    for (std::size_t t = 0; t < tensors().size(); ++t)
      for (Index i = 0; i < tensors()[t].size; ++i) {
        const Index k = tensors()[t].offset + i;
        v(k) = is_dead(tensors(), t) ? T(0) : static_cast<T>(f(k));
      }
    return v;
  }
};

/// The entry's own batch, or the one that it names.
SourcesOptions listed(const Json& entry) {
  const Json list = batch_of(kPoissonId, entry.at("inputs").at("y_star"), "y");
  return {fields(list),
          Index(list.front().size()),
          Index(list.front().front().size())};
}

/// check(place) in both precisions.
template <class F>
void in_both_precisions(const Json& entry, F&& check) {
  const Json rule = entry.at("inputs").at("weights");
  const Recurrence u(rule);
  const SourcesOptions plane = listed(entry);
  const Batch<double>& y = plane.y;
  const auto run_in = [&]<class T>(StageRun& run) {
    const Shape shape = run.oracle.shape();
    NetworkModel<T> model(
        run.setting.predictor, shape, shape.unknowns, nullptr);
    model.load(
        {{"parameters",
          Batch<double>(recurrence_weights(rule, model.network().tensors()))}});
    Batches<T> batches(run, {.size = y.cols()}, 0);
    batches.next();
    const auto signal = solver_loss().make<T>(
        {.run = run,
         .model = model,
         .batches = batches,
         .options = {.gradient_scale = double(y.cols())}});
    check(Place<T>{model, *signal, y}, u);
    return Outcome{};
  };
  const auto stage =
      make_stage({.name = "look", .needs = *solver_loss().hessian}, run_in);
  StageBench bench(*stage,
                   y.cols(),
                   0,
                   problem<ListedPoisson>("poisson", plane),
                   plane_setting(plane));
  for (const Precision p : {Precision::f64, Precision::f32})
    bench.run(nullptr, p);
}

/// Single precision has its own rounding to lose.
template <class T>
Comparator listed_tolerance(const Json& entry) {
  const Comparator exact = EntryTolerance(entry.at("tolerance")).array();
  if (std::is_same_v<T, double>) return exact;
  return {5e-3, exact.atol()};
}

void check_hessian_vector(const Json& entry) {
  const Json want = entry.at("expected");
  in_both_precisions(entry, [&]<class T>(Place<T> at, const Recurrence& u) {
    const auto same = listed_tolerance<T>(entry);
    const Vector<T> z = at.direction([&](Index k) { return u.sign(k); });
    Vector<T> h;
    at.signal.gradient();
    at.signal.hessian_product(z, h);
    EXPECT_TRUE(same(at.norms(h), vector(want.at("norms"))));
    EXPECT_TRUE(same(double(z.dot(h)), number(want.at("zHz"))));
  });
}

void check_ggn_vector(const Json& entry) {
  const Json want = entry.at("expected");
  const auto from =
      static_cast<Index>(setting(entry, "offset", "u\\(k\\+", 100'000));
  in_both_precisions(entry, [&]<class T>(Place<T> at, const Recurrence& u) {
    const auto same = listed_tolerance<T>(entry);
    const Vector<T> v = at.direction([&](Index k) { return u(k + from); });
    Vector<T> g;
    at.signal.gradient();
    const Batch<T> jv = at.model.tangent(v);
    const Vector<double> first = vector(want.at("jv_first"));
    ASSERT_LE(first.size(), jv.rows());
    EXPECT_TRUE(same(jv.col(0).head(first.size()), first));
    EXPECT_TRUE(same(double(jv.norm()), number(want.at("jv_norm"))));
    at.signal.gauss_newton_product(v, g);
    EXPECT_TRUE(same(at.norms(g), vector(want.at("gv_norms"))));
    EXPECT_TRUE(same(double(v.dot(g)), number(want.at("vGv"))));
  });
}

/// After every step: sum and norm of the output, loss, first outputs.
void check_adahessian(const Json& entry) {
  const Batch<double> after = columns(entry.at("expected").at("after_step"));
  const AdaHessianOptions options{
      .rate = setting(entry, "lr", "lr ", 1e-3),
      .power = setting(entry, "power", "power ", 0.5),
      .eps = setting(entry, "eps", "eps ", 1e-4)};
  const auto stride =
      static_cast<Index>(setting(entry, "stride", "index k\\+", 50'000));
  const Index first = after.rows() - 3;
  ASSERT_GE(first, 0);
  in_both_precisions(entry, [&]<class T>(Place<T> at, const Recurrence& u) {
    const auto same = listed_tolerance<T>(entry);
    AdaHessian<T> step(options, at.tensors());
    for (Index t = 1; t <= after.cols(); ++t) {
      const Vector<T> z =
          at.direction([&](Index k) { return u.sign(k + stride * t); });
      const Vector<T> gradient = at.signal.gradient();
      Vector<T> h;
      at.signal.hessian_product(z, h);
      Vector<T>& parameters = at.model.parameters();
      step.step(parameters, gradient, h, parameters);
      const Batch<T> out = at.model.forward(at.y.template cast<T>());
      ASSERT_LE(first, out.rows());
      Vector<double> seen(after.rows());
      seen << out.template cast<double>().sum(),
          out.template cast<double>().norm(), at.signal.objective(),
          out.col(0).head(first).template cast<double>();
      // A sum of many numbers is not more exact than they are.
      const double scale =
          std::is_same_v<T, float> ? 5e-3 * std::sqrt(double(out.size())) : 0;
      for (Index i = 0; i < seen.size(); ++i)
        EXPECT_TRUE(Comparator(same.rtol(), same.atol() + scale)(
            seen(i), after(i, t - 1)))
            << "entry " << i << " after step " << t;
    }
  });
}

/// What is stored of so many iterations, of the file's list up to its first
/// entry above `most`.
std::vector<Index> schedule(const Json& listed, Index most, Index iterations) {
  std::vector<Index> stored = listed;
  double above = 1;
  while (std::ceil(above) - 1 <= double(most)) above *= 1.3;
  EXPECT_EQ(double(stored.back()), std::ceil(above) - 1) << listed.path();
  std::erase_if(stored, [&](Index i) { return i > iterations; });
  if (stored.empty() || stored.back() < iterations)
    stored.push_back(iterations);
  return stored;
}

void check_hessian_free(const Json& entry) {
  const Json want = entry.at("expected");
  const Index most = entry.at("inputs").at("max_cg");
  in_both_precisions(entry, [&]<class T>(Place<T> at, const Recurrence&) {
    const auto same = listed_tolerance<T>(entry);
    HessianFreeRule<T> rule({.solver = {.iterations = most}}, at.model);
    for (const Json& step : want.at("steps")) {
      const auto expect = [&](double seen, const char* key) {
        EXPECT_TRUE(same(seen, number(step.at(key)))) << key;
      };
      ASSERT_TRUE(rule(at.signal));
      const HessianFreeReport& r = rule.reports().back();
      expect(r.before, "loss_before");
      expect(r.after, "loss_after");
      expect(r.rho, "rho");
      const Vector<double> model = Eigen::Map<const Vector<double>>(
          r.model.data(), static_cast<Index>(r.model.size()));
      EXPECT_TRUE(same(model, vector(step.at("model_values"))));
      const Index iterations = step.at("cg_iterations");
      EXPECT_EQ(model.size(), iterations + 1);
      EXPECT_EQ(r.damping, number(step.at("damping_used")));
      EXPECT_DOUBLE_EQ(r.next_damping, number(step.at("damping_next")));
      EXPECT_EQ(r.chosen, step.at("chosen_iterate").get<Index>());
      EXPECT_EQ(r.alpha, number(step.at("alpha")));
      EXPECT_EQ(r.stored, schedule(step.at("stored"), most, iterations));
    }
  });
}

TEST(SipPoissonReference, SecondDerivatives) {
  check_entries("sip-poisson",
                {{"hessian-vector", check_hessian_vector},
                 {"adahessian-*", check_adahessian},
                 {"ggn-vector", check_ggn_vector},
                 {"hessian-free-*", check_hessian_free}},
                {"spectrum",
                 "solve-small",
                 "solve-large",
                 "noise",
                 "unet-forward-*",
                 "training-gradient-*",
                 "three-steps-*",
                 "fno"});
}

}  // namespace
}  // namespace physinv::test
