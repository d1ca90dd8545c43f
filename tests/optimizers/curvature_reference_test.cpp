// The vectors of sip-poisson that are second derivatives: products, AdaHessian
// and Hessian-free, through signal and rules, on the listed batch and from the
// listed weights.
#include "optimizers/training.h"
#include "optimizers/training/adahessian_rule.h"
#include "optimizers/training/batches.h"
#include "optimizers/training/stage.h"
#include "suite/core/linear_problem.h"
#include "suite/nn/unet.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

constexpr Index kCells = 16;

struct SourcesOptions {
  Batch<double> y;
};
Options describe(const SourcesOptions&) { return {}; }

/// lap y = x with zeros around 16 x 16 cells, solved in the sine basis; on a
/// list of observations, whatever set is asked for.
template <class T>
class ListedPoisson final : public LinearProblem<T> {
 public:
  using Options = SourcesOptions;
  explicit ListedPoisson(const Options& options = {})
      : y_(options.y), sines_(kCells, kCells), inverse_(kCells, kCells) {
    const double turn = M_PI / (kCells + 1);
    const auto eigenvalue = [&](Index k) {
      return 2 * std::cos(turn * double(k + 1)) - 2;
    };
    for (Index k = 0; k < kCells; ++k)
      for (Index l = 0; l < kCells; ++l) {
        sines_(k, l) = std::sqrt(2.0 / (kCells + 1)) *
                       std::sin(turn * double((k + 1) * (l + 1)));
        inverse_(k, l) = 1 / (eigenvalue(k) + eigenvalue(l));
      }
  }
  Shape shape() const override { return {kCells * kCells, kCells * kCells, 0}; }
  Vector<double> start() const override {
    return Vector<double>::Zero(kCells * kCells);
  }
  Samples<double> sample(Index first, Index count, const Rng&) const override {
    const Batch<double> y = y_.middleCols(first, count);
    return {y, y, Batch<double>(0, count)};
  }
  void forward(BatchIn<T> x,
               BatchIn<T>,
               BatchOut<T> y,
               Workspace&) const override {
    for (Index i = 0; i < x.cols(); ++i) {
      Batch<double> field =
          x.col(i).template cast<double>().reshaped(kCells, kCells);
      field = sines_ * field * sines_;
      field = sines_ * field.cwiseProduct(inverse_) * sines_;
      y.col(i) = field.reshaped().template cast<T>();
    }
  }
  void linearize(BatchIn<T> x,
                 BatchIn<T> given,
                 BatchOut<T> y,
                 Tape&) const override {
    Workspace none;
    forward(x, given, y, none);
  }
  void pullback(const Tape&,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    forward(y_bar, y_bar.topRows(0), x_bar, work);
  }
  double operations() const override { return 1; }

 private:
  Batch<double> y_, sines_, inverse_;
};

Setting plane_setting() {
  const auto net = nn::unet({.grid = {kCells, kCells},
                             .padding = nn::Padding::circular,
                             .batch_statistics = true});
  return {.predictor = {{Field::observations}, net}, .surrogate = {}};
}

/// The formula of an entry: integers that repeat after m.
struct Formula {
  explicit Formula(const Json& rule)
      : a(rule.at("a")), b(rule.at("b")), c(rule.at("c")), m(rule.at("m")) {}
  Index residue(Index k) const { return (a * k * k + b * k + c) % m; }
  double u(Index k) const {
    return 2.0 * double(residue(k)) / double(m - 1) - 1;
  }
  /// +-1, by parity.
  double sign(Index k) const { return residue(k) % 2 == 0 ? 1 : -1; }
  Index a, b, c, m;
};

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

  const std::vector<TensorInfo>& tensors() const {
    return model.network().tensors();
  }
  Vector<double> norms(const Vector<T>& v) const {
    Vector<double> all(static_cast<Index>(tensors().size()));
    Index t = 0;
    for (const TensorInfo& info : tensors())
      all(t++) =
          v.segment(info.offset, info.size).template cast<double>().norm();
    return all;
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

Batch<double> weights(const Formula& of, const std::vector<TensorInfo>& all) {
  Batch<double> w(all.back().offset + all.back().size, 1);
  for (const TensorInfo& t : all)
    for (Index k = t.offset; k < t.offset + t.size; ++k)
      w(k) = t.kind == 's'   ? 1 + 0.1 * of.u(k)
             : t.kind == 'o' ? 0.1 * of.u(k)
                             : of.u(k) / std::sqrt(double(t.fan_in));
  EXPECT_EQ(w.size(), 37'697);
  return w;
}

Batch<double> listed_batch() {
  const Json entry = reference_entries("sip-poisson", "unet-forward-16x16")[0];
  const Json& fields = entry.at("inputs").at("y");
  Batch<double> y(kCells * kCells, static_cast<Index>(fields.size()));
  Index i = 0;
  for (const Json& field : fields)
    y.col(i++) = Batch<double>(rows(field).transpose()).reshaped();
  return y;
}

/// check(place) in both precisions.
template <class F>
void in_both(const Json& entry, F&& check) {
  EXPECT_EQ(entry.at("inputs").at("y_star"), "the batch of unet-forward-16x16");
  const Formula formula(entry.at("inputs").at("weights"));
  const Batch<double> y = listed_batch();
  const auto run_in = [&]<class T>(StageRun& run) {
    const Shape shape = run.oracle.shape();
    NetworkModel<T> model(
        run.setting.predictor, shape, shape.unknowns, nullptr);
    model.load({{"parameters", weights(formula, model.network().tensors())}});
    Batches<T> batches(run, {.size = y.cols()}, 0);
    batches.next();
    const auto signal = solver_loss().make<T>(
        {.run = run,
         .model = model,
         .batches = batches,
         .options = {.gradient_scale = double(y.cols())}});
    check(Place<T>{model, *signal}, formula);
    return Outcome{};
  };
  const auto stage =
      make_stage({.name = "look", .needs = *solver_loss().hessian}, run_in);
  StageBench bench(*stage,
                   y.cols(),
                   0,
                   problem<ListedPoisson>("poisson", {y}),
                   plane_setting());
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

void expect_all_keys(const Json& want, const std::set<std::string>& known) {
  std::set<std::string> found;
  for (const auto& [key, value] : want.items()) found.insert(key);
  EXPECT_EQ(found, known);
}

void check_hessian_vector(const Json& entry) {
  const Json& want = entry.at("expected");
  expect_all_keys(want, {"norms", "zHz"});
  in_both(entry, [&]<class T>(Place<T> at, const Formula& formula) {
    const auto same = listed_tolerance<T>(entry);
    const Vector<T> z = at.direction([&](Index k) { return formula.sign(k); });
    Vector<T> h;
    at.signal.gradient();
    at.signal.hessian_product(z, h);
    EXPECT_TRUE(same(at.norms(h), vector(want.at("norms"))));
    EXPECT_TRUE(same(double(z.dot(h)), want.at("zHz").get<double>()));
  });
}

void check_ggn_vector(const Json& entry) {
  const Json& want = entry.at("expected");
  expect_all_keys(want, {"jv_first", "jv_norm", "gv_norms", "vGv"});
  in_both(entry, [&]<class T>(Place<T> at, const Formula& formula) {
    const auto same = listed_tolerance<T>(entry);
    const Vector<T> v =
        at.direction([&](Index k) { return formula.u(k + 100'000); });
    Vector<T> g;
    at.signal.gradient();
    const Batch<T> jv = at.model.tangent(v);
    EXPECT_TRUE(same(Vector<double>(jv.col(0).head(6).template cast<double>()),
                     vector(want.at("jv_first"))));
    EXPECT_TRUE(same(double(jv.norm()), want.at("jv_norm").get<double>()));
    at.signal.gauss_newton_product(v, g);
    EXPECT_TRUE(same(at.norms(g), vector(want.at("gv_norms"))));
    EXPECT_TRUE(same(double(v.dot(g)), want.at("vGv").get<double>()));
  });
}

void check_adahessian(const Json& entry) {
  const Json& want = entry.at("expected");
  expect_all_keys(want, {"after_step"});
  const Batch<double> y = listed_batch();
  in_both(entry, [&]<class T>(Place<T> at, const Formula& formula) {
    const auto same = listed_tolerance<T>(entry);
    AdaHessian<T> step({.rate = 1e-3}, at.tensors());
    Index t = 0;
    for (const Json& after : want.at("after_step")) {
      ++t;
      const Vector<T> z =
          at.direction([&](Index k) { return formula.sign(k + 50'000 * t); });
      const Vector<T> gradient = at.signal.gradient();
      Vector<T> h;
      at.signal.hessian_product(z, h);
      Vector<T>& parameters = at.model.parameters();
      step.step(parameters, gradient, h, parameters);
      const Batch<T> out = at.model.forward(y.cast<T>());
      Vector<double> seen(8);
      seen << out.template cast<double>().sum(),
          out.template cast<double>().norm(), at.signal.objective(),
          out.col(0).head(5).template cast<double>();
      for (Index i = 0; i < 8; ++i) {
        // A sum of 512 numbers is no more exact than they are.
        const double scale =
            std::is_same_v<T, float> ? 5e-3 * std::sqrt(512) : 0;
        const double stored = after.at(static_cast<std::size_t>(i));
        EXPECT_TRUE(
            Comparator(same.rtol(), same.atol() + scale)(seen(i), stored))
            << "entry " << i << " after step " << t;
      }
    }
  });
}

void check_hessian_free(const Json& entry) {
  const Json& want = entry.at("expected");
  expect_all_keys(want, {"steps"});
  const auto most = entry.at("inputs").at("max_cg").get<Index>();
  in_both(entry, [&]<class T>(Place<T> at, const Formula&) {
    const auto same = listed_tolerance<T>(entry);
    HessianFreeRule<T> rule({.solver = {.iterations = most}}, at.model);
    for (const Json& step : want.at("steps")) {
      expect_all_keys(step,
                      {"loss_before",
                       "model_values",
                       "cg_iterations",
                       "rho",
                       "damping_used",
                       "damping_next",
                       "chosen_iterate",
                       "alpha",
                       "loss_after",
                       "stored"});
      const auto expect = [&](double seen, const char* key) {
        EXPECT_TRUE(same(seen, step.at(key).get<double>())) << key;
      };
      ASSERT_TRUE(rule(at.signal));
      const HessianFreeReport& r = rule.reports().back();
      expect(r.before, "loss_before");
      expect(r.after, "loss_after");
      expect(r.rho, "rho");
      const Vector<double> model = Eigen::Map<const Vector<double>>(
          r.model.data(), static_cast<Index>(r.model.size()));
      EXPECT_TRUE(same(model, vector(step.at("model_values"))));
      EXPECT_EQ(r.model.size(),
                step.at("cg_iterations").get<std::size_t>() + 1);
      EXPECT_EQ(r.damping, step.at("damping_used").get<double>());
      EXPECT_DOUBLE_EQ(r.next_damping, step.at("damping_next").get<double>());
      EXPECT_EQ(r.chosen, step.at("chosen_iterate").get<Index>());
      EXPECT_EQ(r.alpha, step.at("alpha").get<double>());
      // The schedule's first entry above the cap stands for the last iterate.
      auto schedule = step.at("stored").get<std::vector<Index>>();
      double above = 1;
      while (std::ceil(above) - 1 <= double(most)) above *= 1.3;
      EXPECT_EQ(double(schedule.back()), std::ceil(above) - 1);
      schedule.back() = most;
      EXPECT_EQ(r.stored, schedule);
    }
  });
}

TEST(SipPoissonReference, SecondDerivatives) {
  check_entries("sip-poisson",
                {{"hessian-vector", check_hessian_vector},
                 {"adahessian-two-steps", check_adahessian},
                 {"ggn-vector", check_ggn_vector},
                 {"hessian-free-two-steps", check_hessian_free}},
                {"spectrum",
                 "solve-small",
                 "solve-large",
                 "noise",
                 "unet-forward-16x16",
                 "unet-forward-20x15",
                 "training-gradient-l2",
                 "training-gradient-sip",
                 "three-steps-sgd",
                 "three-steps-adam",
                 "three-steps-sip",
                 "fno"});
}

}  // namespace
}  // namespace physinv::test
