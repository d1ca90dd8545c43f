// The updates of hig-oscillators, and its first-order rules.
#include <gtest/gtest.h>

#include <map>

#include "optimizers/steps/rule.h"
#include "problems/oscillators/oscillators.h"
#include "tests/optimizers/hig_learner.h"

namespace physinv::test {
namespace {

Learner oscillators() {
  return {.problem = problems::oscillators().make<double>(),
          .single = problems::oscillators().make<float>(),
          .network = {{4, 20, 20, 20, 96}, nn::Activation::relu},
          .factor = [](Index b) { return 1.0 / static_cast<double>(b); },
          .given_is_target = true};
}

/// Every other setting of the rules is the specification's (section 4).
void check_rules(const Json& entry) {
  const Json in = entry.at("input"), out = entry.at("expected");
  const auto same = HigTolerance(entry).array();
  const double rate = in.at("lr");
  const std::map<std::string, StepOptions> rules = {
      {"sgd", SgdOptions{.rate = rate}},
      {"adam", AdamOptions{.rate = rate, .eps_before_correction = true}},
      {"adagrad", AdagradOptions{.rate = rate}},
      {"rmsprop", RmspropOptions{.rate = rate}},
      {"adadelta", AdadeltaOptions{.rate = rate}}};
  const Json gradients = in.at("grads");
  for (const auto& [name, after] : out.items()) {
    ASSERT_TRUE(rules.contains(name)) << "no test knows the rule " << name;
    ASSERT_EQ(after.size(), gradients.size()) << name;
    UpdateStep<double> step(rules.at(name));
    Vector<double> theta = flat(in.at("theta"));
    for (std::size_t t = 0; t < gradients.size(); ++t) {
      step(theta, flat(gradients.at(t), theta.size()));
      EXPECT_TRUE(same(theta, flat(after.at(t)))) << name << t;
    }
  }
}

// The solver's own entries: tests/problems/oscillators_reference_test.cpp.
TEST(HigReference, Oscillators) {
  const Learner l = oscillators();
  check_entries("hig-oscillators",
                {{"batch*", [&](const Json& e) { check_batch(l, "x0", e); }},
                 {"sequence_*",
                  [&](const Json& e) {
                    check_sequence(l, "x0", e.at("input").at("batch"), e);
                  }},
                 {"first_order_rules", check_rules}},
                {"solver_*", "one_step_tangent"});
}

}  // namespace
}  // namespace physinv::test
