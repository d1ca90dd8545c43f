// Every entry of jpo-gradient-alignment, each checked by what carries it out.

#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "problems/noisy_absolute/noisy_absolute.h"
#include "suite/cases/jpo/gradient_alignment/theory.h"
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
    return align_single_sine(c.at("lam"), c.at("a"));
  });
}

void check_response_curve(const Json& entry) {
  const auto near = EntryTolerance(entry).array();
  const auto sizes = entry.at("N").get<std::vector<Index>>();
  for (const Json& c : entry.at("cases")) {
    for (const bool clamped : {false, true}) {
      const auto rho = response_curve(100000, {c.at("C"), c.at("A"), clamped});
      const Json& stored = c.at(clamped ? "clamped" : "literal");
      ASSERT_EQ(stored.size(), sizes.size());
      for (std::size_t i = 0; i < sizes.size(); ++i)
        EXPECT_TRUE(near(rho[static_cast<std::size_t>(sizes[i] - 1)],
                         number(stored[i])));
      if (!clamped) {
        EXPECT_TRUE(near(rho.back(), number(c.at("limit_N_1e5"))));
      }
    }
  }
}

void check_noise(const Json& entry) {
  const auto near = EntryTolerance(entry).array();
  const Batch<double> a = columns(entry.at("A"));
  const Batch<double> w = columns(entry.at("omega"));
  const Index n = a.cols();
  const NoisyAbsolute<double> problem({.terms = a.rows()});
  Batch<double> given(problem.shape().given, n);
  given << Batch<double>::Zero(1, n), vector(entry.at("x_star")).transpose(),
      vector(entry.at("lam")).transpose(), a, w, columns(entry.at("phi"));
  const Batch<double> x = vector(entry.at("x")).transpose();
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

template <class T>
void check_step(const Json& entry,
                const TinyNetOptions& options,
                const Comparator& near_x,
                const Comparator& near_delta) {
  const auto net = one_step<T>(options);
  set_formula_weights<T>(*net, options.hidden, entry.at("shift"));
  const Vector<double> gamma = vector(entry.at("gamma"));
  const Vector<double> sign = vector(entry.at("sign"));
  const Index n = gamma.size();
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
    SCOPED_TRACE(run.at("kind").dump());
    const Buffer g = to_lanes<T>(vector(run.at("gradient")));
    net->respond(static_cast<const Pack<T>*>(g.data()), p);
    const Vector<double> delta = lane(0);
    EXPECT_TRUE(near_delta(delta, vector(run.at("delta_x"))));
    EXPECT_EQ(delta, lane(kLanes<T> - 1));
    for (Index i = 0; i < n; ++i)
      EXPECT_EQ(delta(i) * sign(i) < 0,
                run.at("aligned").at(static_cast<std::size_t>(i)).get<bool>());
  }
}

void check_steps(const Json& entry, const TinyNetOptions& options) {
  const auto near = EntryTolerance(entry).array();
  check_step<double>(entry, options, near, near);
  check_step<float>(entry, options, {1e-4, 0}, {1e-3, 0});
}

void check_sine(const Json& entry) { check_steps(entry, {}); }

void check_linear(const Json& entry) {
  check_steps(entry,
              {.hidden = {32, 32, 32},
               .activation = TinyActivation::tanh,
               .scale = 40,
               .range = 1});
}

TEST(GradientAlignmentReference, EveryEntry) {
  const std::map<std::string, std::function<void(const Json&)>> checks = {
      {"theory_sum", check_sum},
      {"theory_vote", check_vote},
      {"single_sine", check_single_sine},
      {"rho_recursion", check_response_curve},
      {"noise_instance", check_noise},
      {"response_sin", check_sine},
      {"response_linear", check_linear}};
  const Json file = load_reference(kId);
  ASSERT_FALSE(file.at("entries").empty());
  for (const Json& entry : file.at("entries")) {
    const auto name = entry.at("name").get<std::string>();
    SCOPED_TRACE(name);
    ASSERT_TRUE(checks.contains(name)) << "no test reads this entry";
    checks.at(name)(entry);
  }
}

}  // namespace
}  // namespace physinv::test
