// Stages that look instead of solving, on problems whose answers are known.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "problems/exponential/exponential.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/diagnostics/diagnostic.h"
#include "suite/diagnostics/growth.h"
#include "suite/diagnostics/stability_sweep.h"
#include "suite/diagnostics/work_precision.h"
#include "tests/support/quadratic.h"

namespace physinv::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct ToyOptions {
  double slope_error = 0;  ///< added to the pullback's first entry
  auto fields() const { return std::tuple{field("slope_error", slope_error)}; }
};

/// y = (exp(x0), sqrt(x1^2 + 1e8^2) - 1e8): overflows in float before double,
/// and float loses the second entry altogether.
template <class T>
class Toy final : public Problem<T>, public Vjp<T>, public Jacobian<T> {
 public:
  using Options = ToyOptions;
  explicit Toy(const Options& options = {}) : options_(options) {}

  Shape shape() const override { return {2, 2, 0}; }
  Vector<double> start() const override { return Eigen::Vector2d(0, 0); }
  void draw(Stream&, SampleOut&) const override {}
  Drawn drawn() const override { return Drawn::both; }
  void forward(Point<T> at, BatchOut<T> y, Workspace&) const override {
    const auto& x = at.x;
    constexpr T kOffset = 1e8;
    for (Index i = 0; i < x.cols(); ++i) {
      y(0, i) = std::exp(x(0, i));
      y(1, i) = std::sqrt(x(1, i) * x(1, i) + kOffset * kOffset) - kOffset;
    }
  }
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const auto& x = at.x;
    Workspace none;
    forward(at, y, none);
    auto j = tape.slot<T>(0, 2, x.cols());
    slopes(x, j);
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace&) const override {
    x_bar = tape.view<T>(0).cwiseProduct(y_bar);
    x_bar.row(0).array() += T(options_.slope_error);
  }
  void jacobian(Point<T> at, BatchOut<T> j, Workspace&) const override {
    const auto& x = at.x;
    Batch<T> slope(2, x.cols());
    slopes(x, slope);
    j.setZero();
    j.row(0) = slope.row(0);
    j.row(3) = slope.row(1);
  }
  double operations() const override { return 10; }

 private:
  static void slopes(BatchIn<T> x, BatchOut<T> slope) {
    slope.row(0) = x.row(0).array().exp();
    slope.row(1) =
        x.row(1).array() / (x.row(1).array().square() + T(1e16)).sqrt();
  }
  Options options_;
};

Arrays sweep(const ToyOptions& toy, std::vector<Eigen::Vector2d> xs) {
  StabilitySweepOptions options{.problems = {problem<Toy>("toy", toy)},
                                .points = {}};
  for (const auto& x : xs) options.points.push_back({0, x});
  const auto stage = stability_sweep(options);
  return StageBench(*stage, 2).run().arrays;
}

using Statuses = std::vector<SweepStatus>;

Statuses statuses(const Batch<double>& status, Index cell) {
  Statuses out;
  for (Index c = 0; c < status.rows(); ++c)
    out.push_back(static_cast<SweepStatus>(static_cast<int>(status(c, cell))));
  return out;
}

constexpr auto kOk = SweepStatus::ok, kBad = SweepStatus::inaccurate,
               kGone = SweepStatus::diverged;

TEST(StabilitySweep, GivesEveryCellAStatusAndNoNan) {
  const auto found =
      sweep({}, {{1, 0}, {1, 1e4}, {100, 0}, {800, 0}, {kNan, 0}});
  const auto& status = found.at("status");
  const auto& error = found.at("error");
  ASSERT_EQ(status.cols(), 5);
  EXPECT_EQ(statuses(status, 0), (Statuses{kOk, kOk, kOk, kOk, kOk}));
  // One half of 1e8, too little for a float.
  EXPECT_EQ(status(1, 1), double(kBad));
  EXPECT_NEAR(error(1, 1), 0.5 / std::hypot(0.5, std::exp(1)), 1e-6);
  EXPECT_EQ(status(2, 1), double(kOk));
  EXPECT_EQ(statuses(status, 2), (Statuses{kOk, kGone, kOk, kOk, kGone}));
  EXPECT_EQ(statuses(status, 3), Statuses(5, kGone));
  EXPECT_EQ(statuses(status, 4), Statuses(5, kGone));
  EXPECT_TRUE(error.allFinite());
  EXPECT_EQ(error.col(3).maxCoeff(), -1);
}

TEST(StabilitySweep, FindsAWrongAdjoint) {
  for (const double wrong : {1e-3, -1e-3}) {
    const auto found = sweep({.slope_error = wrong}, {{1, 0}});
    EXPECT_EQ(statuses(found.at("status"), 0),
              (Statuses{kOk, kOk, kBad, kBad, kOk}));
    EXPECT_GT(found.at("error")(2, 0), 1e-5);
  }
}

TEST(StabilitySweep, DecidesNothingWithoutAJacobian) {
  StabilitySweepOptions options{
      .problems = {problem<GradientQuadratic>("quadratic")}, .points = {}};
  options.points.push_back({0, Eigen::Vector2d(1, 2)});
  const auto stage = stability_sweep(options);
  const auto found = StageBench(*stage, 2).run().arrays;
  EXPECT_EQ(found.at("status")(2, 0), double(kOk));
  EXPECT_EQ(found.at("status")(3, 0), double(SweepStatus::undecided));
}

TEST(StabilitySweep, ExamplesStandSideBySideAndOptionsTellPointsApart) {
  StabilitySweepOptions options{
      .problems = {quadratic(), quadratic({.broken_above = 0})},
      .points = {},
      .examples = 2};
  options.points = {{0, Eigen::Vector2d(1, 0)}, {1, Eigen::Vector2d(1, 0)}};
  const auto stage = stability_sweep(options);
  const auto found = StageBench(*stage, 2).run().arrays;
  EXPECT_EQ(found.at("status").row(0),
            Eigen::RowVector4d(
                double(kOk), double(kOk), double(kGone), double(kGone)));
  options.points.back() = {1, Eigen::Vector2d(1, 1e-9)};
  EXPECT_NE(stability_sweep(options)->options(), stage->options());
}

TEST(Extrapolation, IsExactForCubicsAndSkipsWhatIsNotFinite) {
  Vector<double> d(8);
  for (Index k = 0; k < 8; ++k) d(k) = 2 + 3 * std::pow(0.1 / (1 << 2 * k), 2);
  EXPECT_NEAR(extrapolate(d).value, 2, 1e-15);
  EXPECT_LT(extrapolate(d).uncertainty, 1e-15);
  d.head(4).setConstant(kNan);
  EXPECT_NEAR(extrapolate(d).value, 2, 1e-15);
  d.setConstant(kNan);
  EXPECT_FALSE(extrapolate(d).found);
  // Too wide a step for a bounded function: small values, but not alike.
  for (Index k = 0; k < 8; ++k)
    d(k) = k < 4 ? std::cos(double(7 * k)) * 1e-3 * (1 << 2 * k) : 2e3;
  EXPECT_NEAR(extrapolate(d).value, 2e3, 1e-9);
  // Noise in the smallest steps is not believed.
  for (Index k = 0; k < 8; ++k)
    d(k) = 2 + std::pow(0.1 / (1 << 2 * k), 2) + (k > 4 ? k % 2 : 0);
  EXPECT_NEAR(extrapolate(d).value, 2, 1e-6);
}

TEST(WorkPrecision, MeasuresTheDistanceToTheReference) {
  const auto stage = work_precision({.name = "same",
                                     .problem = quadratic(),
                                     .base = quadratic(),
                                     .reference = quadratic()});
  StageBench exact(*stage, 3, 4), rough(*stage, 3, 4);
  const auto error = exact.run(nullptr, Precision::f64).arrays.at("error");
  EXPECT_LT(error.maxCoeff(), 1e-15);
  const auto coarse = rough.run(nullptr, Precision::f32).arrays.at("error");
  EXPECT_GT(coarse.maxCoeff(), 1e-9);
  EXPECT_LT(coarse.maxCoeff(), 1e-6);
  EXPECT_EQ(exact.probe.iteration(), 4);
  EXPECT_EQ(exact.oracle.counts()[Counter::forward], 12U);
  EXPECT_GT(fastest_repetition(exact.probe.curve()), 0);

  const auto broken = work_precision({.name = "broken",
                                      .problem = quadratic({-2}),
                                      .base = quadratic(),
                                      .reference = quadratic()});
  EXPECT_EQ(StageBench(*broken, 3, 1).run().arrays.at("error").maxCoeff(), -1);
}

/// The quadratic in numbers of twice the digits, its first row times `factor`.
ClosedForm quadratic_form(double factor) {
  return {[=](auto x, auto given, auto y) {
    const auto a = GradientQuadratic<double>::matrix();
    for (std::size_t j = 0; j < 2; ++j) {
      const auto row = static_cast<Index>(j);
      y[j] = (j == 0 ? factor : 1) * (a(row, 0) * x[0] + a(row, 1) * x[1]) +
             given[j];
    }
  }};
}

TEST(WorkPrecision, MeasuresGradientsAgainstAClosedForm) {
  const auto error = [](double factor, Precision precision) {
    const auto stage = work_precision({.name = "gradient",
                                       .problem = quadratic(),
                                       .base = quadratic(),
                                       .exact = quadratic_form(factor),
                                       .of = WorkOf::gradient,
                                       .samples = 5,
                                       .block = 2,
                                       .repetitions = 1});
    StageBench bench(*stage, 3, 1);
    const auto out = bench.run(nullptr, precision);
    EXPECT_EQ(bench.oracle.counts()[Counter::vjp], 5U);
    EXPECT_EQ(out.arrays.at("error").cols(), 5);
    return out.arrays.at("error").maxCoeff();
  };
  EXPECT_LT(error(1, Precision::f64), 1e-15);
  EXPECT_LT(error(1, Precision::f32), 1e-6);
  EXPECT_GT(error(1, Precision::f32), 1e-9);
  EXPECT_GT(error(1.001, Precision::f64), 1e-5);
}

/// y = x + given, point by point: given is a wave over one period.
struct PointwiseOptions {
  Index steps = 2;
  auto fields() const { return std::tuple{field("steps", steps)}; }
};
template <class T>
class Pointwise final : public Problem<T>, public Vjp<T> {
 public:
  using Options = PointwiseOptions;
  explicit Pointwise(const Options& o = {}) : n_(o.steps) {}
  Shape shape() const override { return {n_, n_, n_}; }
  Vector<double> start() const override { return Vector<double>::Zero(n_); }
  void draw(Stream&, SampleOut& sample) const override {
    for (Index k = 0; k < n_; ++k) {
      sample.x(k) = double(k + 1) + double(sample.index);
      sample.given(k) = std::cos(2 * std::numbers::pi * double(k) / double(n_));
    }
  }
  void forward(Point<T> at, BatchOut<T> y, Workspace&) const override {
    const auto &x = at.x, &given = at.given;
    y = x + given;
  }
  void linearize(Point<T> at, BatchOut<T> y, Tape&) const override {
    const auto &x = at.x, &given = at.given;
    y = x + given;
  }
  void pullback(const Tape&,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace&) const override {
    x_bar = y_bar;
  }
  double operations() const override { return 1; }

 private:
  Index n_;
};

TEST(WorkPrecision, FinerSettingsSeeTheSameFunctions) {
  const auto pointwise = [](Index steps) {
    return problem<Pointwise>("pointwise", {.steps = steps});
  };
  // On the points that the settings share they agree exactly; a field that was
  // not interpolated, unknowns that were not repeated would not.
  for (const bool gradient : {false, true}) {
    const auto stage =
        work_precision({.name = "fine",
                        .problem = pointwise(16),
                        .base = pointwise(8),
                        .reference = pointwise(64),
                        .of = gradient ? WorkOf::gradient : WorkOf::forward});
    const auto error = StageBench(*stage, 3, 1)
                           .run(nullptr, Precision::f64)
                           .arrays.at("error");
    EXPECT_LT(error.maxCoeff(), 1e-14) << gradient;
  }
}

TEST(WorkPrecision, InversesAreMeasuredAgainstTheUnknowns) {
  const auto exponential = problems::exponential();
  const auto stage = work_precision({.name = "inverse",
                                     .problem = exponential,
                                     .base = exponential,
                                     .of = WorkOf::inverse});
  EXPECT_EQ(stage->needs(), Needs::forward | Needs::inverse);
  for (const Precision p : {Precision::f64, Precision::f32}) {
    StageBench bench(*stage, 32, 2, exponential);
    const auto error = bench.run(nullptr, p).arrays.at("error");
    EXPECT_EQ(error.cols(), 32);
    EXPECT_LT(error.maxCoeff(), p == Precision::f64 ? 1e-13 : 1e-4);
    EXPECT_GT(error.maxCoeff(), 0);
    EXPECT_EQ(bench.oracle.counts()[Counter::inverse], 64U);
  }
}

TEST(WorkPrecision, TheFastestRepetitionIsPerIteration) {
  EXPECT_EQ(fastest_repetition({}), 0);
  const Curve curve{.iteration = {0, 1, 3}, .seconds = {0, 4, 10}};
  EXPECT_EQ(fastest_repetition(curve), 3);
}

TEST(Growth, OfALinearProblemIsKnown) {
  const auto stage =
      growth({.horizons = {{1, quadratic()}, {2, quadratic({-2})}}});
  const auto found = StageBench(*stage, 5).run().arrays;
  EXPECT_EQ(found.at("time"), Eigen::RowVector2d(1, 2));
  // y = A x + given.
  EXPECT_LT((found.at("perturbation").col(0).array() - 1).abs().maxCoeff(),
            1e-6);
  EXPECT_LT(
      (found.at("perturbation_single").col(0).array() - 1).abs().maxCoeff(),
      1e-3);
  EXPECT_GT(found.at("gradient").col(0).minCoeff(), 0);
  EXPECT_LT(found.at("gradient_error").col(0).maxCoeff(), 1e-5);
  EXPECT_LT(found.at("rounding").col(0).maxCoeff(), 1e-6);
  EXPECT_EQ(found.at("perturbation").col(1).maxCoeff(), -1);
  EXPECT_EQ(found.at("rounding").col(1).maxCoeff(), -1);
}

TEST(Diagnostic, LeavesTheStartAndOnePoint) {
  const auto stage = growth({.horizons = {{1, quadratic()}}});
  StageBench bench(*stage, 3);
  const Outcome out = bench.run();
  EXPECT_EQ(out.x, bench.oracle.start());
  EXPECT_EQ(bench.probe.curve().points(), 1);
  EXPECT_EQ(stage->options().front().second, "diagnostic");
}

}  // namespace
}  // namespace physinv::test
