// The vectors of physgrad-scaling: steps through the stages themselves, the
// rest from the problem.
#include <cmath>

#include "optimizers/local_steps.h"
#include "problems/scaling/scaling.h"
#include "tests/optimizers/scaling_support.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kId = "physgrad-scaling";

/// Every number by itself. In float no closer than 1e-5, and `lost`.
class Expect {
 public:
  Expect(const Json& entry, bool single_precision, double lost = 0) {
    const Json& t = entry.at("tolerance");
    rtol_ = t.at("rtol").get<double>(), atol_ = t.at("atol").get<double>();
    if (single_precision)
      rtol_ = std::max(rtol_, 1e-5), atol_ = std::max(atol_, lost);
  }
  void operator()(double got, const Json& wanted) const {
    const auto want = wanted.get<double>();
    EXPECT_LE(std::abs(got - want), atol_ + rtol_ * std::abs(want))
        << got << ", expected " << want;
  }
  void operator()(const Batch<double>& got, const Json& samples) const {
    ASSERT_EQ(static_cast<std::size_t>(got.cols()), samples.size());
    for (Index j = 0; j < got.cols(); ++j)
      for (Index i = 0; i < got.rows(); ++i) {
        SCOPED_TRACE(testing::Message() << i << ", " << j);
        (*this)(got(i, j), samples.at(std::size_t(j)).at(std::size_t(i)));
      }
  }
  void list(const Vector<double>& got, const Json& numbers) const {
    (*this)(Batch<double>(got), Json::array({numbers}));
  }

 private:
  double rtol_, atol_;
};

void expect_keys(const Json& entry, const std::set<std::string>& known) {
  for (const auto& [key, value] : entry.at("expected").items())
    EXPECT_TRUE(known.contains(key)) << "nobody reads " << key;
}

LocalStep step_of(const std::string& method) {
  static const std::map<std::string, LocalStep> kSteps = {
      {"gd", LocalStep::gradient},
      {"newton", LocalStep::newton},
      {"ig", LocalStep::inverse_gradient},
      {"pg", LocalStep::inverse_simulator}};
  return kSteps.at(method);
}

std::array<double, 2> pair(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>()};
}

AimedOptions problem_of(const Json& in, const char* start) {
  AimedOptions o;
  o.scaling = {.scales = {in.value("alpha", 1.0)},
               .power = in.at("problem") == "comparison" ? 2 : 1,
               .half = in.value("loss", "square") == "half",
               .start = pair(in.at(start))};
  if (in.contains("y_target")) o.target = pair(in.at("y_target"));
  return o;
}

template <class T>
void check_step(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  const Expect expect(entry, sizeof(T) == 4);
  const AimedOptions options = problem_of(in, "x");
  const Aimed<T> problem(options);
  const auto data = problem.sample(0, 1, Rng::root("", 0)).template cast<T>();
  const Batch<T> x = problem.start().template cast<T>();
  Batch<T> y(2, 1), y_bar(2, 1), g(2, 1), m(4, 1);
  Vector<double> loss(1);
  Workspace work;
  Tape tape;
  const auto matrix = [&] {
    return Batch<double>(m.template cast<double>().reshaped(2, 2));
  };
  problem.linearize(x, data.given, y, tape);
  problem.loss(y, data.y, loss);
  problem.loss_gradient(y, data.y, y_bar);
  problem.pullback(tape, y_bar, g, work);
  expect.list(y.template cast<double>(), want.at("y"));
  expect(loss(0), want.at("loss"));
  expect.list(g.template cast<double>(), want.at("gradient"));
  problem.hessian(x, data.given, data.y, m, work);
  expect(matrix(), want.at("hessian"));
  problem.jacobian(x, data.given, m, work);
  expect(matrix(), want.at("jacobian"));

  const double eta = in.at("eta").get<double>();
  for (const std::string method : {"gd", "newton", "ig", "pg"}) {
    SCOPED_TRACE(method);
    const Batch<double> path = path_of<T>(options, step_of(method), eta, 1);
    Expect(entry, sizeof(T) == 4, 1e-7)  // as a difference
        .list(path.col(1) - path.col(0), want.at("step_" + method));
  }
  expect_keys(entry,
              {"y",
               "loss",
               "gradient",
               "hessian",
               "jacobian",
               "step_gd",
               "step_newton",
               "step_ig",
               "step_pg"});
}

template <class T>
Batch<double> run(const Json& in,
                  const Json& alpha,
                  const std::string& method) {
  AimedOptions options = problem_of(
      {{"problem", in.at("problem")}, {"start", in.at("start")}}, "start");
  options.scaling.scales = {alpha.get<double>()};
  return path_of<T>(options,
                    step_of(method),
                    in.at("eta").get<double>(),
                    in.at("steps").get<Index>());
}

template <class T>
void check_trajectory(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  const Expect expect(entry, sizeof(T) == 4);
  Json alphas = in.value("alpha", Json(1.0));
  if (!alphas.is_array()) alphas = Json::array({alphas});
  const Json methods =
      in.value("methods", Json::array({in.value("method", "")}));
  for (const Json& alpha : alphas)
    for (const Json& method : methods) {
      SCOPED_TRACE(method.get<std::string>() + " " + alpha.dump());
      const Batch<double> x = run<T>(in, alpha, method.get<std::string>());
      Batch<double> stored = x;
      if (in.contains("stored_steps")) {
        const auto kept = in.at("stored_steps").get<std::vector<Index>>();
        stored = x(Eigen::all, kept);
      }
      expect(stored, want.at("x"));
      if (!want.contains("y")) continue;
      Batch<double> y = x;
      y.row(1) = x.row(1).cwiseAbs2();
      expect(y, want.at("y"));
      expect.list(y.colwise().squaredNorm().transpose(), want.at("loss"));
      expect.list(x.colwise().norm().transpose(), want.at("distance"));
      const Vector<double> u = x.col(0) - x.col(1);
      expect(u.sum() / u.norm(), want.at("diagonal_length_first_update"));
    }
  expect_keys(entry,
              {"x", "y", "loss", "distance", "diagonal_length_first_update"});
}

/// The root of z^2 = y.
template <class T>
void check_local_inverse(const Json& entry) {
  const Json& in = entry.at("inputs");
  const Vector<double> y = vector(in.at("y")), x0 = vector(in.at("x0"));
  const Scaling<T> problem({.power = 2});
  Batch<T> at(2, y.size()), guess(2, y.size()), x(2, y.size());
  at << y.transpose().cast<T>(), y.transpose().cast<T>();
  guess << x0.transpose().cast<T>(), x0.transpose().cast<T>();
  Workspace work;
  problem.invert(at, Batch<T>::Ones(1, y.size()), guess, x, work);
  Expect(entry, sizeof(T) == 4)
      .list(x.row(1).transpose().template cast<double>(),
            entry.at("expected").at("x"));
  expect_keys(entry, {"x"});
}

/// L = alpha x2 is what the second observation is.
template <class T>
void check_linear_loss(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  const Expect expect(entry, sizeof(T) == 4);
  const Vector<double> alphas = vector(in.at("alpha"));
  const auto eta = static_cast<T>(in.at("eta").get<double>());
  const auto wanted = static_cast<T>(in.at("delta_loss").get<double>());
  const Scaling<T> problem;
  const Index n = alphas.size();
  const Batch<T> given = alphas.transpose().cast<T>();
  const Batch<T> zero = Batch<T>::Zero(2, n);
  Batch<T> one = zero, goal = zero, y = zero, gradient = zero, dx = zero;
  one.row(1).setOnes(), goal.row(1).setConstant(wanted);
  Workspace work;
  Tape tape;
  const auto check = [&](const std::string& method) {
    problem.forward(dx, given, y, work);
    expect.list(dx.row(1).transpose().template cast<double>(),
                want.at("step_" + method));
    expect.list(y.row(1).transpose().template cast<double>(),
                want.at("loss_change_" + method));
  };
  problem.linearize(zero, given, y, tape);
  problem.pullback(tape, one, gradient, work);
  dx = -eta * gradient;
  check("gd");
  problem.inverse_gradient_step(zero, given, goal, dx);
  check("ig");
  expect_keys(entry,
              {"step_gd", "loss_change_gd", "step_ig", "loss_change_ig"});
}

void check_numeric_inverse(const Json& entry) {
  const Json& in = entry.at("inputs");
  const Scaling<double> problem({.power = 2});
  for (const double h : {1e-8, 0.0}) {
    NumericInverse search(problem, {.difference = h});
    Batch<double> x(2, 1);
    search.invert(vector(in.at("target")),
                  Batch<double>::Ones(1, 1),
                  vector(in.at("start")),
                  x);
    Expect(entry, false).list(x, entry.at("expected").at("x"));
  }
  expect_keys(entry, {"x"});
}

TEST(PhysgradScalingReference, EveryEntryInBothPrecisions) {
  const auto both = [](auto single, auto full) {
    return [=](const Json& entry) {
      single(entry);
      full(entry);
    };
  };
  const auto step = both(check_step<float>, check_step<double>);
  const auto trajectory =
      both(check_trajectory<float>, check_trajectory<double>);
  std::map<std::string, EntryCheck> checks = {
      {"step-half-loss", step},
      {"inverted-trajectory-any-alpha", trajectory},
      {"local-inverse",
       both(check_local_inverse<float>, check_local_inverse<double>)},
      {"linear-loss",
       both(check_linear_loss<float>, check_linear_loss<double>)},
      {"numeric-inverse", check_numeric_inverse}};
  for (const std::string alpha : {"1", "3", "5"}) {
    checks["step-alpha-" + alpha] = step;
    checks["gd-trajectory-alpha-" + alpha] = trajectory;
  }
  for (const std::string name : {"comparison-gd",
                                 "comparison-newton",
                                 "comparison-ig",
                                 "comparison-pg",
                                 "figure1-newton-0.5-10",
                                 "figure1-newton-0.1-100",
                                 "figure1-pg-0.05-100",
                                 "figure1-gd-0.01389-10",
                                 "figure1-gd-0.005-1000"})
    checks[name] = trajectory;
  check_entries(kId, checks);
}

}  // namespace
}  // namespace physinv::test
