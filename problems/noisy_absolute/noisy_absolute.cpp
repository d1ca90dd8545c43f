#include "problems/noisy_absolute/noisy_absolute.h"

#include <numbers>

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"
#include "suite/core/simd/math.h"

namespace physinv {
namespace {

enum Row : Index { kGamma, kSolution, kLambda, kNoise };

/// A block of columns as one evaluation sees it; lanes beyond it repeat the
/// last column.
template <class T>
struct Block {
  const T* data;
  Index stride, count;

  Pack<T> row(Index r) const {
    Pack<T> lanes;
    for (Index k = 0; k < kLanes<T>; ++k)
      lanes[k] = data[std::min(k, count - 1) * stride + r];
    return lanes;
  }
};

/// Loss and its derivative.
template <class T>
void evaluate(
    Index terms, Block<T> given, Block<T> at, Pack<T>& y, Pack<T>& slope) {
  constexpr T kTurn = T(0.5) * std::numbers::inv_pi_v<T>;
  const Pack<T> x = at.row(0), away = x - given.row(kSolution);
  const Pack<T> lambda = given.row(kLambda);
  y = lambda * abs_lanes(away);
  slope = lambda * sign_lanes(away);
  for (Index j = 0; j < terms; ++j) {
    const Pack<T> a = given.row(kNoise + j);
    const Pack<T> w = given.row(kNoise + terms + j);
    const Pack<T> phi = given.row(kNoise + 2 * terms + j);
    const Pack<T> turns = (w * x + phi) * kTurn;
    const Pack<T> part = turns - round_lanes(turns);
    y -= a * sin_turns(part + T(0.25));
    slope += a * w * sin_turns(part);
  }
}

/// Runs body(i, y, slope) for every column.
template <class T, class F>
void for_columns(Index terms, const Point<T>& at, F&& body) {
  const auto &x = at.x, &given = at.given;
  for (Index first = 0; first < x.cols(); first += kLanes<T>) {
    const Index count = std::min<Index>(kLanes<T>, x.cols() - first);
    Pack<T> y, slope;
    evaluate<T>(terms,
                {given.col(first).data(), given.outerStride(), count},
                {x.col(first).data(), x.outerStride(), count},
                y,
                slope);
    for (Index k = 0; k < count; ++k) body(first + k, y[k], slope[k]);
  }
}

double solution_at(Solution solution, double gamma) {
  if (solution == Solution::zero) return 0;
  return solution == Solution::linear ? 10 * gamma : math::sin(2 * gamma);
}

}  // namespace

double noise_level(VectorIn<double> amplitude, VectorIn<double> omega) {
  return amplitude.cwiseProduct(omega).norm();
}

namespace {

template <class T>
class NoisyAbsolute final : public Problem<T>, public Vjp<T> {
 public:
  explicit NoisyAbsolute(const NoisyAbsoluteOptions& options)
      : options_(options) {
    check_numbers<T>({{"gamma", options.gamma},
                      {"omega_min", options.omega_min},
                      {"omega_max", options.omega_max},
                      {"level", options.level},
                      {"decades", options.decades},
                      {"snr", options.snr}});
    SUITE_CHECK(options.terms >= 0, "the number of terms must not be negative");
    SUITE_CHECK(options.gamma > 0, "gamma must be positive");
    SUITE_CHECK(options.level >= 0 && options.decades >= 0 && options.snr >= 0,
                "decades and snr must not be negative");
    SUITE_CHECK(options.omega_max >= options.omega_min,
                "omega_max must not be less than omega_min");
  }

  Shape shape() const override { return {1, 1, 3 + 3 * options_.terms}; }
  Vector<double> start() const override { return Vector<double>::Zero(1); }

  /// x = x*, of labelled samples x* + U(-1, 1), off the kink.
  void draw(Stream& stream, SampleOut& sample) const override {
    const Index m = options_.terms;
    auto& given = sample.given;
    given(kGamma) = stream.uniform(-options_.gamma, options_.gamma);
    given(kSolution) = solution_at(options_.solution, given(kGamma));
    const double level =
        options_.level *
        math::pow(10, options_.decades * stream.uniform(-1.0, 1.0));
    given(kLambda) = options_.snr * level;
    const double away = stream.uniform(-1.0, 1.0);
    sample.x(0) = given(kSolution) + (sample.labelled ? away : 0);
    auto a = given.segment(kNoise, m), w = given.segment(kNoise + m, m);
    for (Index j = 0; j < m; ++j) {
      a(j) = stream.uniform();
      w(j) = stream.uniform(options_.omega_min, options_.omega_max);
      given(kNoise + 2 * m + j) = 2 * std::numbers::pi * stream.uniform();
    }
    const double drawn = noise_level(a, w);
    if (drawn > 0) a *= level / drawn;
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace&) const override {
    for_columns<T>(
        options_.terms, at, [&](Index i, T loss, T) { y(0, i) = loss; });
  }
  void loss(BatchIn<T> y,
            BatchIn<T> target,
            VectorOut<double> loss) const override {
    loss = (y - target).row(0).transpose().template cast<double>();
  }
  void loss_gradient(BatchIn<T> /*y*/,
                     BatchIn<T> /*target*/,
                     BatchOut<T> y_bar) const override {
    y_bar.setOnes();
  }
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    auto slopes = tape.slot<T>(0, 1, y.cols());
    for_columns<T>(options_.terms, at, [&](Index i, T loss, T slope) {
      y(0, i) = loss, slopes(0, i) = slope;
    });
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace&) const override {
    x_bar = tape.view<T>(0).cwiseProduct(y_bar);
  }

  /// A sine or cosine counts as 10.
  double operations() const override {
    return 4 + 25 * static_cast<double>(options_.terms);
  }

 private:
  NoisyAbsoluteOptions options_;
};

}  // namespace

ProblemRecipe problems::noisy_absolute(const NoisyAbsoluteOptions& options) {
  return problem<NoisyAbsolute>(
      "noisy_absolute",
      options,
      {.unknowns = {"x"},
       .observations = {"loss"},
       .given = {"gamma, x*, lambda, amplitudes(term), frequencies(term), "
                 "phases(term)"}});
}

}  // namespace physinv
