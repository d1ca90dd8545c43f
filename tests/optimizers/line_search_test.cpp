#include "optimizers/steps/line_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace physinv {
namespace {

using Next = LineSearch::Next;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

struct Value {
  double f, d;
};

struct Trace {
  Next end = Next::evaluate;
  double step = 0;
  std::vector<double> steps;
};

/// Searches along phi, with the slope at 0 possibly not its derivative.
Trace search(const std::function<Value(double)>& phi,
             Value origin,
             double first,
             LineSearchOptions options = {}) {
  LineSearch line;
  Trace trace;
  trace.end = line.start(options, origin.f, origin.d, first);
  while (trace.end == Next::evaluate) {
    trace.steps.push_back(line.step());
    const Value v = phi(line.step());
    trace.end = line.supply(options, v.f, v.d);
    if (trace.steps.size() > 500) break;
  }
  trace.step = line.step();
  return trace;
}

void expect_wolfe(const Trace& t, const std::function<Value(double)>& phi) {
  ASSERT_EQ(t.end, Next::accept);
  const Value a = phi(t.step), o = phi(0);
  EXPECT_LE(a.f, o.f + 1e-4 * t.step * o.d);
  EXPECT_LE(std::abs(a.d), 0.9 * std::abs(o.d));
}

TEST(LineSearch, AcceptsTheFirstGoodStep) {
  const auto phi = [](double a) { return Value{(a - 1) * (a - 1), 2 * a - 2}; };
  const Trace t = search(phi, phi(0), 1);
  EXPECT_EQ(t.end, Next::accept);
  EXPECT_EQ(t.steps, std::vector<double>{1});
}

TEST(LineSearch, ExtrapolatesAndInterpolates) {
  const auto far = [](double a) {
    return Value{(a - 40) * (a - 40), 2 * (a - 40)};
  };
  expect_wolfe(search(far, far(0), 0.01), far);
  const auto near = [](double a) {
    const double b = a - 1e-3;
    return Value{b * b, 2 * b};
  };
  expect_wolfe(search(near, near(0), 1), near);
  const auto wavy = [](double a) {
    return Value{-a / 10 + std::sin(9 * a) / 20 + a * a / 50,
                 -0.1 + 0.45 * std::cos(9 * a) + a / 25};
  };
  const Value start{0, -0.1};
  for (double first = 0.05; first < 1; first += 0.05) {
    const Trace t = search(wavy, start, first);
    EXPECT_TRUE(t.end == Next::accept || t.end == Next::fail);
  }
}

TEST(LineSearch, RisingSlopeFailsSearchOneBeforeItEvaluates) {
  // Search 2 evaluates a1 once per doubling, rejects, and zooms in vain.
  const auto phi = [](double a) { return Value{a, 1}; };
  const Trace t = search(phi, {0, 1}, 1);
  EXPECT_EQ(t.end, Next::fail);
  // f = a <= phi0 + c1 a d0 never holds: zoom at once, 11 rounds.
  EXPECT_EQ(t.steps.size(), 12U);
  EXPECT_EQ(t.steps.front(), 1);
}

TEST(LineSearch, ZeroFirstStepFailsWithoutEvaluation) {
  const Trace t = search([](double) { return Value{0, -1}; }, {0, -1}, 0);
  EXPECT_EQ(t.end, Next::fail);
  EXPECT_TRUE(t.steps.empty());
}

TEST(LineSearch, TinyFirstStepGoesToSearchTwo) {
  const auto phi = [](double a) { return Value{-a, -1}; };
  const Trace t = search(phi, {0, -1}, 1e-120);
  // Slope never flattens: ten doublings, then the step as it is.
  EXPECT_EQ(t.end, Next::accept);
  ASSERT_EQ(t.steps.size(), 11U);
  EXPECT_DOUBLE_EQ(t.step, 1024e-120);
}

TEST(LineSearch, UnboundedDescentEndsInDoublings) {
  // Search 1 extrapolates to the bound and gives up; search 2 restarts.
  const auto phi = [](double a) { return Value{-a, -1}; };
  const Trace t = search(phi, {0, -1}, 1);
  EXPECT_EQ(t.end, Next::accept);
  EXPECT_EQ(t.step, 1024);
  EXPECT_GT(t.steps.size(), 11U);
}

TEST(LineSearch, NonFiniteTrialRestartsThenEnds) {
  const Trace t = search([](double) { return Value{kNan, 0}; }, {0, -1}, 0.5);
  EXPECT_EQ(t.end, Next::nonfinite);
  EXPECT_EQ(t.steps, (std::vector<double>{0.5, 0.5}));
}

TEST(LineSearch, SearchTwoHalvesItsIntervalAtInfinity) {
  // A wall of +inf beyond 0.3, whatever the slope there is.
  for (const double slope : {0.0, kNan, kInf, -kInf}) {
    const auto phi = [&](double a) {
      return a > 0.3 ? Value{kInf, slope}
                     : Value{(a - 0.2) * (a - 0.2), 2 * (a - 0.2)};
    };
    const Trace t = search(phi, {0.04, -0.4}, 1);
    EXPECT_EQ(t.end, Next::accept);
    EXPECT_EQ(t.steps, (std::vector<double>{1, 1, 0.5, 0.25}));
  }
}

TEST(LineSearch, AcceptsNoInfinityAndNoNan) {
  // The doublings end in the wall: its point is not accepted.
  const auto wall = [](double a) {
    return a > 600e-120 ? Value{kInf, 0} : Value{-a, -1};
  };
  EXPECT_EQ(search(wall, {0, -1}, 1e-120).end, Next::nonfinite);
  const auto everywhere = [](double) { return Value{kInf, kNan}; };
  EXPECT_EQ(search(everywhere, {0, -1}, 1).end, Next::fail);
  const auto below = [](double) { return Value{-kInf, 0}; };
  EXPECT_EQ(search(below, {0, -1}, 1).end, Next::nonfinite);
}

TEST(LineSearch, NonFiniteBeyondTheRestartIsSurvived) {
  // Search 1 jumps from 1 to 5 into the NaN; search 2 stops at 2.
  const auto phi = [](double a) {
    return a > 2.5 ? Value{kNan, kNan} : Value{-a, a < 1.5 ? -1 : -0.5};
  };
  const Trace t = search(phi, {0, -1}, 1);
  EXPECT_EQ(t.end, Next::accept);
  EXPECT_EQ(t.steps, (std::vector<double>{1, 5, 1, 2}));
}

TEST(LineSearch, NonFiniteInsideTheZoomEnds) {
  int calls = 0;
  const auto phi = [&](double a) {
    if (++calls == 1) return Value{kNan, kNan};
    return a == 1 ? Value{3, 1} : Value{-1, kNan};
  };
  const Trace t = search(phi, {0, -1}, 1);
  EXPECT_EQ(t.end, Next::nonfinite);
  EXPECT_EQ(calls, 3);
}

TEST(LineSearch, ZoomFindsAWolfePoint) {
  // First call fails search 1, so everything after is search 2.
  for (const double first : {0.03, 0.3, 1.0}) {
    int calls = 0;
    const auto phi = [](double a) {
      return Value{std::pow(a - 0.2, 4) + (a - 0.2) * (a - 0.2),
                   4 * std::pow(a - 0.2, 3) + 2 * (a - 0.2)};
    };
    const auto broken_once = [&](double a) {
      return ++calls == 1 ? Value{kNan, kNan} : phi(a);
    };
    expect_wolfe(search(broken_once, phi(0), first), phi);
  }
}

TEST(LineSearch, NanSlopeOrStepIsNonFinite) {
  const auto phi = [](double) { return Value{0, 0}; };
  EXPECT_EQ(search(phi, {0, kNan}, 1).end, Next::nonfinite);
  EXPECT_EQ(search(phi, {0, -1}, kNan).end, Next::nonfinite);
}

TEST(LineSearch, SearchOneObeysItsEvaluations) {
  // The function keeps falling ever steeper, so no step is ever accepted.
  int calls = 0;
  const auto phi = [&](double a) {
    ++calls;
    return Value{-a - a * a, -1 - 2 * a};
  };
  LineSearchOptions options;
  options.max_evaluations = 7;
  const Trace t = search(phi, {0, -1}, 1e-3, options);
  EXPECT_EQ(t.end, Next::accept);  // the doublings' last step
  EXPECT_EQ(calls, 7 + 11);
}

}  // namespace
}  // namespace physinv
