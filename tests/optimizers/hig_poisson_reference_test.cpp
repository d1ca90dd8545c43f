// The updates of hig-poisson.
#include <gtest/gtest.h>

#include "optimizers/steps/rule.h"
#include "problems/grid_poisson/grid_poisson.h"
#include "tests/optimizers/hig_learner.h"

namespace physinv::test {
namespace {

Learner poisson() {
  return {.problem = std::make_unique<GridPoisson<double>>(),
          .single = std::make_unique<GridPoisson<float>>(),
          .network = {{64, 64, 256, 64, 64}, nn::Activation::tanh},
          .factor = [](Index) { return 1.0; }};
}

TEST(HigReference, Poisson) {
  const Learner l = poisson();
  int seen = 0;
  const Json file = load_reference("hig-poisson");
  for (const Json& e : file.at("entries")) {
    const std::string name = e.at("name");
    SCOPED_TRACE(name);
    if (name.starts_with("batch")) {
      Expected out(e);
      check_batch(l, "rho", e, out);
      ++seen;
    }
    if (name == "hig_three_updates") check_sequence(l, "rho", 2, e), ++seen;
    if (name != "adam_three_steps") continue;
    const Json& in = e.at("input");
    Expected out(e);
    const auto same = HigTolerance(e).array();
    const Batch<double> rho = flat_columns(in.at("rho"));
    UpdateStep<double> step(
        AdamOptions{.rate = in.at("lr"), .eps_before_correction = true});
    Vector<double> theta = l.network.start(in);
    const Vector<double> losses = flat(out.at("losses"));
    for (Index k = 0; k < losses.size(); ++k) {
      At at(l, theta, rho);
      EXPECT_TRUE(same(at.loss.mean(), losses(k)));
      if (k + 1 < losses.size()) step(theta, at.gradient());
    }
    EXPECT_TRUE(same.summary(theta, out.at("theta_final")));
    ++seen;
  }
  EXPECT_GE(seen, 4);
}

}  // namespace
}  // namespace physinv::test
