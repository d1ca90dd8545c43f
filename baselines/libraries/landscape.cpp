#include "landscape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>

#include "suite/core/check.h"

namespace libraries {
namespace {

using physinv::Batch;
using physinv::BatchIn;
using physinv::BatchOut;
using physinv::Vector;
using physinv::VectorOut;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double rosenbrock(const double* x, double* slope) {
  const double a = 1 - x[0], b = x[1] - x[0] * x[0];
  slope[0] = -2 * a - 400 * x[0] * b;
  slope[1] = 200 * b;
  return a * a + 100 * b * b;
}

double bowl(const double* x, double* slope) {
  slope[0] = x[0], slope[1] = x[1];
  return (x[0] * x[0] + x[1] * x[1]) / 2;
}

/// Up the bowl instead of down.
double uphill(const double* x, double* slope) {
  slope[0] = -x[0], slope[1] = -x[1];
  return (x[0] * x[0] + x[1] * x[1]) / 2;
}

/// Without a slope at its bottom.
double lost_slope(const double* x, double* slope) {
  slope[0] = x[0] < 0.5 ? kNan : x[0], slope[1] = x[1];
  return (x[0] * x[0] + x[1] * x[1]) / 2;
}

/// Lowest at (-1, -1), outside of boxes of positive numbers.
double corner(const double* x, double* slope) {
  const double a = x[0] + 1, b = x[1] + 1;
  slope[0] = a, slope[1] = b;
  return (a * a + b * b) / 2;
}

/// Two minima at (1, 0) and (-1, 0), a saddle between them.
double double_well(const double* x, double* slope) {
  const double a = x[0] * x[0] - 1;
  slope[0] = x[0] * a, slope[1] = x[1];
  return a * a / 4 + x[1] * x[1] / 2;
}

double kink(const double* x, double* slope) {
  const auto sign = [](double v) { return v > 0 ? 1.0 : v < 0 ? -1.0 : 0.0; };
  slope[0] = sign(x[0]), slope[1] = sign(x[1] - 0.3);
  return std::abs(x[0]) + std::abs(x[1] - 0.3);
}

/// One everywhere below 1, lowest at 3.
double plateau(const double* x, double* slope) {
  slope[0] = x[0] < 1 ? 0 : (x[0] - 3) / 2;
  return x[0] < 1 ? 1 : (x[0] - 3) * (x[0] - 3) / 4;
}

/// Steep and lowest at 0.01, which is next to the wall at 0.
template <bool kIsNan>
double wall(const double* x, double* slope) {
  const double a = x[0] - 0.01;
  const bool beyond = !(x[0] > 0);
  slope[0] = !beyond ? 2e4 * a : kIsNan ? kNan : -kInfinity;
  return !beyond ? 1e4 * a * a : kIsNan ? kNan : kInfinity;
}

struct Function {
  double (*f)(const double* x, double* slope);
  std::size_t unknowns;
};

const Function& function_of(std::string_view name) {
  static const std::map<std::string_view, Function> kFunctions = {
      {"bowl", {bowl, 2}},
      {"corner", {corner, 2}},
      {"double_well", {double_well, 2}},
      {"infinite_wall", {wall<false>, 1}},
      {"kink", {kink, 2}},
      {"lost_slope", {lost_slope, 2}},
      {"nan_wall", {wall<true>, 1}},
      {"plateau", {plateau, 1}},
      {"rosenbrock", {rosenbrock, 2}},
      {"uphill", {uphill, 2}}};
  const auto at = kFunctions.find(name);
  SUITE_CHECK(at != kFunctions.end(), "there is no such landscape");
  return at->second;
}

enum Slot : std::size_t { kSlope };

template <class T>
class Landscape final : public physinv::Problem<T>, public physinv::Vjp<T> {
 public:
  explicit Landscape(const LandscapeOptions& options)
      : options_(options), function_(function_of(options.function)) {
    const std::size_t bounds = options.lower.size();
    SUITE_CHECK(options.start.size() == function_.unknowns &&
                    options.upper.size() == bounds &&
                    (bounds == 0 || bounds == function_.unknowns),
                "start and bounds have a number for each unknown");
  }

  physinv::Shape shape() const override {
    return {static_cast<Index>(function_.unknowns),
            1,
            static_cast<Index>(2 * options_.lower.size())};
  }
  Vector<double> start() const override {
    return Eigen::Map<const Vector<double>>(
        options_.start.data(), static_cast<Index>(options_.start.size()));
  }
  double operations() const override { return 20; }

  physinv::Drawn drawn() const override { return physinv::Drawn::observations; }
  void draw(physinv::Stream&, physinv::SampleOut& sample) const override {
    const auto& [lower, upper] = std::tie(options_.lower, options_.upper);
    std::copy(lower.begin(), lower.end(), sample.given.begin());
    std::copy(upper.begin(),
              upper.end(),
              sample.given.begin() + static_cast<Index>(lower.size()));
  }

  void forward(physinv::Point<T> at,
               BatchOut<T> y,
               physinv::Workspace&) const override {
    Batch<T> slope(at.x.rows(), y.cols());
    evaluate(at, y, slope);
  }
  void linearize(physinv::Point<T> at,
                 BatchOut<T> y,
                 physinv::Tape& tape) const override {
    auto slope = tape.slot<T>(kSlope, at.x.rows(), y.cols());
    evaluate(at, y, slope);
  }
  void pullback(const physinv::Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                physinv::Workspace&) const override {
    x_bar = tape.view<T>(kSlope).array().rowwise() * y_bar.row(0).array();
  }

  void loss(BatchIn<T> y, BatchIn<T>, VectorOut<double> loss) const override {
    loss = y.row(0).transpose().template cast<double>();
  }
  void loss_gradient(BatchIn<T>, BatchIn<T>, BatchOut<T> y_bar) const override {
    y_bar.setOnes();
  }

 private:
  void evaluate(physinv::Point<T> at, BatchOut<T> y, BatchOut<T> slope) const {
    Vector<double> x(at.x.rows()), of_x(at.x.rows());
    for (Index i = 0; i < y.cols(); ++i) {
      x = at.x.col(i).template cast<double>();
      y(0, i) =
          static_cast<T>(options_.scale * function_.f(x.data(), of_x.data()));
      slope.col(i) = (options_.scale * of_x).template cast<T>();
    }
  }

  LandscapeOptions options_;
  Function function_;
};

}  // namespace

physinv::ProblemRecipe landscape(const LandscapeOptions& options) {
  return physinv::problem<Landscape>(
      "landscape",
      options,
      {.unknowns = {"x"}, .observations = {"loss"}, .given = {"bounds"}});
}

}  // namespace libraries
