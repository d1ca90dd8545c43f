// Every entry of jpo-gradient-alignment, each checked by what carries it out.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "problems/noisy_absolute/noisy_absolute.h"
#include "suite/cases/jpo/gradient_alignment/theory.h"
#include "suite/core/any_problem.h"
#include "suite/diagnostics/one_step.h"
#include "tests/support/formula_weights.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kId = "jpo-gradient-alignment";

/// value(case) against every case's stored value, one by one.
template <class F>
void check_cases(const Json& entry, F&& value) {
  const auto near = EntryTolerance(entry).array();
  ASSERT_FALSE(entry.at("cases").empty());
  for (const Json& c : entry.at("cases"))
    EXPECT_TRUE(near(value(c), number(c.at("value")))) << c.dump();
}

void check_sum(const Json& entry) {
  check_cases(entry,
              [](const Json& c) { return align_sum(c.at("N"), c.at("snr")); });
}

void check_vote(const Json& entry) {
  check_cases(entry,
              [](const Json& c) { return align_vote(c.at("N"), c.at("snr")); });
}

void check_single_sine(const Json& entry) {
  check_cases(entry, [](const Json& c) {
    return align_single_sine(number(c.at("lam")), number(c.at("a")));
  });
}

void check_response_curve(const Json& entry) {
  const auto near = EntryTolerance(entry).array();
  const std::vector<Index> sizes = entry.at("N");
  ASSERT_FALSE(sizes.empty());
  constexpr Index kLimit = 100'000;  // limit_N_1e5
  const Index longest =
      std::max(kLimit, *std::max_element(sizes.begin(), sizes.end()));
  for (const Json& c : entry.at("cases")) {
    SCOPED_TRACE("C " + c.at("C").dump() + ", A " + c.at("A").dump());
    for (const bool clamped : {false, true}) {
      const auto rho = response_curve(longest, {c.at("C"), c.at("A"), clamped});
      const auto at = [&](Index n) {
        return rho.at(static_cast<std::size_t>(n - 1));
      };
      const Json stored = c.at(clamped ? "clamped" : "literal");
      ASSERT_EQ(stored.size(), sizes.size());
      for (std::size_t i = 0; i < sizes.size(); ++i)
        EXPECT_TRUE(near(at(sizes[i]), number(stored[i]))) << sizes[i];
      if (!clamped) {
        EXPECT_TRUE(near(at(kLimit), number(c.at("limit_N_1e5"))));
      }
    }
  }
}

void check_noise(const Json& entry) {
  const auto near = EntryTolerance(entry).array();
  const Batch<double> a = columns(entry.at("A"));
  const Index n = a.cols();
  const Batch<double> w = columns(entry.at("omega"), a.rows(), n),
                      phi = columns(entry.at("phi"), a.rows(), n);
  const AnyProblem<double> problem(
      problems::noisy_absolute({.terms = a.rows()}));
  Batch<double> given(problem.shape().given, n);
  given << Batch<double>::Zero(1, n), vector(entry.at("x_star"), n).transpose(),
      vector(entry.at("lam"), n).transpose(), a, w, phi;
  const Batch<double> x = vector(entry.at("x"), n).transpose();
  Batch<double> y(1, n), y_bar(1, n), x_bar(1, n);
  Tape tape;
  Workspace work;
  problem.linearize(x, given, y, tape);
  problem.loss_gradient(y, y, y_bar);
  problem.pullback(tape, y_bar, x_bar, work);
  Vector<double> level(n);
  for (Index i = 0; i < n; ++i) level(i) = noise_level(a.col(i), w.col(i));
  EXPECT_TRUE(near(y.transpose(), vector(entry.at("loss"))));
  EXPECT_TRUE(near(x_bar.transpose(), vector(entry.at("gradient"))));
  EXPECT_TRUE(near(level, vector(entry.at("level"))));
}

/// The formula weights of a network, the same in every lane.
template <class T>
void set_formula_weights(OneStep<T>& net,
                         const std::vector<Index>& hidden,
                         double shift) {
  auto theta = net.parameters();
  std::size_t at = 0, tensor = 0;
  const auto add = [&](char kind, Index fan_in, Index size) {
    for (Index k = 0; k < size; ++k)
      theta[at++] =
          static_cast<T>(formula_weight(kind, fan_in, tensor, k, shift)) -
          Pack<T>{};
    ++tensor;
  };
  Index in = 1;
  std::vector<Index> widths = hidden;
  widths.push_back(1);
  for (const Index out : widths) {
    add('m', in, in * out);
    add('b', in, out);
    in = out;
  }
  ASSERT_EQ(at, theta.size());
}

template <class T>
Buffer to_lanes(const Vector<double>& v) {
  Buffer out;
  auto* p = static_cast<Pack<T>*>(
      out.reserve(static_cast<std::size_t>(v.size()) * sizeof(Pack<T>)));
  for (Index i = 0; i < v.size(); ++i) p[i] = static_cast<T>(v(i)) - Pack<T>{};
  return out;
}

/// What pushes the outputs in a run of this kind.
Vector<double> push(const std::string& kind,
                    const Vector<double>& sign,
                    const Vector<double>& noise) {
  if (kind == "noise_free") return sign;
  if (kind == "sum") return sign + noise;
  if (kind == "vote") return (sign + noise).cwiseSign();
  throw std::runtime_error("no test carries out the kind " + kind);
}

template <class T>
void check_step(const Json& entry,
                const TinyNetOptions& options,
                const Comparator& near_x,
                const Comparator& near_delta) {
  const auto net = one_step<T>(options);
  set_formula_weights<T>(*net, options.hidden, formula_shift(kId, entry));
  const Vector<double> gamma = vector(entry.at("gamma"));
  ASSERT_GE(gamma.size(), 1);
  const Index n = gamma.size();
  const Vector<double> sign = vector(entry.at("sign"), n);
  const Vector<double> noise = vector(entry.at("noise"), n);
  const Buffer in = to_lanes<T>(gamma);
  Buffer out = to_lanes<T>(gamma);
  auto* p = static_cast<Pack<T>*>(out.data());
  net->predict(static_cast<const Pack<T>*>(in.data()), n, p);
  const auto lane = [&](Index k) {
    Vector<double> v(n);
    for (Index i = 0; i < n; ++i) v(i) = static_cast<double>(p[i][k]);
    return v;
  };
  EXPECT_TRUE(near_x(lane(0), vector(entry.at("x"))));
  ASSERT_FALSE(entry.at("runs").empty());
  for (const Json& run : entry.at("runs")) {
    const std::string kind = run.at("kind");
    SCOPED_TRACE(kind);
    const Vector<double> gradient = vector(run.at("gradient"), n);
    EXPECT_TRUE(Comparator(1e-14, 0)(push(kind, sign, noise), gradient));
    const Buffer g = to_lanes<T>(gradient);
    net->respond(static_cast<const Pack<T>*>(g.data()), p);
    const Vector<double> delta = lane(0), stored = vector(run.at("delta_x"), n);
    EXPECT_TRUE(near_delta(delta, stored));
    EXPECT_EQ(delta, lane(kLanes<T> - 1));
    const std::vector<bool> aligned = run.at("aligned");
    ASSERT_EQ(static_cast<Index>(aligned.size()), n);
    const double doubt =
        near_delta.atol() + near_delta.rtol() * stored.cwiseAbs().maxCoeff();
    for (Index i = 0; i < n; ++i) {
      if (std::abs(stored(i)) <= doubt) continue;  // rounding may turn it
      EXPECT_EQ(delta(i) * sign(i) < 0, aligned[static_cast<std::size_t>(i)]);
    }
  }
}

void check_steps(const Json& entry, const TinyNetOptions& options) {
  const auto near = EntryTolerance(entry).array();
  check_step<double>(entry, options, near, near);
  check_step<float>(entry, options, {1e-4, 0}, {1e-3, 0});
}

/// The network of the specification, as wide and with such a scale as the
/// description says.
void check_steps_of(const Json& entry, TinyNetOptions options) {
  std::vector<Index> sizes = {1};
  sizes.insert(sizes.end(), options.hidden.begin(), options.hidden.end());
  sizes.push_back(1);
  sizes = layer_sizes(entry, sizes);
  options.hidden = {sizes.begin() + 1, sizes.end() - 1};
  options.scale = setting(entry, "scale", "output times", options.scale);
  options.range =
      std::max(options.range, vector(entry.at("gamma")).cwiseAbs().maxCoeff());
  check_steps(entry, options);
}

void check_sine(const Json& entry) { check_steps_of(entry, {}); }

void check_linear(const Json& entry) {
  check_steps_of(entry,
                 {.hidden = {32, 32, 32},
                  .activation = TinyActivation::tanh,
                  .scale = 40,
                  .range = 1});
}

TEST(GradientAlignmentReference, EveryEntry) {
  check_entries(kId,
                {{"theory_sum", check_sum},
                 {"theory_vote", check_vote},
                 {"single_sine", check_single_sine},
                 {"rho_recursion", check_response_curve},
                 {"noise_instance", check_noise},
                 {"response_sin", check_sine},
                 {"response_linear", check_linear}});
}

}  // namespace
}  // namespace physinv::test
