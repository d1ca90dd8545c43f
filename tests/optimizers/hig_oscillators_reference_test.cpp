// The updates of hig-oscillators, and its first-order rules.
#include <gtest/gtest.h>

#include <map>

#include "optimizers/steps/rule.h"
#include "problems/oscillators/oscillators.h"
#include "tests/optimizers/hig_learner.h"

namespace physinv::test {
namespace {

Learner oscillators() {
  return {.problem = std::make_unique<Oscillators<double>>(),
          .single = std::make_unique<Oscillators<float>>(),
          .network = {{4, 20, 20, 20, 96}, nn::Activation::relu},
          .factor = [](Index b) { return 1.0 / static_cast<double>(b); },
          .given_is_target = true};
}

TEST(HigReference, Oscillators) {
  const Learner l = oscillators();
  int seen = 0;
  const Json file = load_reference("hig-oscillators");
  for (const Json& e : file.at("entries")) {
    const std::string name = e.at("name");
    SCOPED_TRACE(name);
    if (name.starts_with("batch")) {
      Expected out(e);
      check_batch(l, "x0", e, out);
      ++seen;
    }
    if (name.starts_with("sequence"))
      check_sequence(l, "x0", e.at("input").at("batch"), e), ++seen;
  }
  EXPECT_GE(seen, 5);
}

TEST(HigReference, FirstOrderRules) {
  int seen = 0;
  const Json file = load_reference("hig-oscillators");
  for (const Json& e : file.at("entries")) {
    if (e.at("name") != "first_order_rules") continue;
    const Json& in = e.at("input");
    Expected out(e);
    const auto same = HigTolerance(e).array();
    const double rate = in.at("lr");
    const std::map<std::string, StepOptions> rules = {
        {"sgd", SgdOptions{.rate = rate}},
        {"adam", AdamOptions{.rate = rate, .eps_before_correction = true}},
        {"adagrad", AdagradOptions{.rate = rate}},
        {"rmsprop", RmspropOptions{.rate = rate}},
        {"adadelta", AdadeltaOptions{.rate = rate}}};
    for (const auto& [name, options] : rules) {
      UpdateStep<double> step(options);
      Vector<double> theta = flat(in.at("theta"));
      for (std::size_t t = 0; t < in.at("grads").size(); ++t) {
        step(theta, flat(in.at("grads").at(t)));
        EXPECT_TRUE(same(theta, flat(out.at(name).at(t)))) << name << t;
      }
      ++seen;
    }
  }
  EXPECT_EQ(seen, 5);
}

}  // namespace
}  // namespace physinv::test
