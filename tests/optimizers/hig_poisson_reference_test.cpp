// The updates of hig-poisson.
#include <gtest/gtest.h>

#include "optimizers/steps/rule.h"
#include "problems/grid_poisson/grid_poisson.h"
#include "tests/optimizers/hig_learner.h"

namespace physinv::test {
namespace {

Learner poisson() {
  return {.problem = problems::grid_poisson().make<double>(),
          .single = problems::grid_poisson().make<float>(),
          .network = {{64, 64, 256, 64, 64}, nn::Activation::tanh},
          .factor = [](Index) { return 1.0; }};
}

void check_adam(const Learner& l, const Json& entry) {
  const Json in = entry.at("input"), out = entry.at("expected");
  const auto same = HigTolerance(entry).array();
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
}

// The solver's own entries: tests/problems/grid_poisson_reference_test.cpp.
TEST(HigReference, Poisson) {
  const Learner l = poisson();
  const auto batch = [](const Json& entry) {
    return static_cast<Index>(setting(entry, "batch", "\\bb", 2));
  };
  check_entries(
      "hig-poisson",
      {{"batch*", [&](const Json& e) { check_batch(l, "rho", e); }},
       {"hig_*", [&](const Json& e) { check_sequence(l, "rho", batch(e), e); }},
       {"adam_*", [&](const Json& e) { check_adam(l, e); }}},
      {"laplacian", "sample_*"});
}

}  // namespace
}  // namespace physinv::test
