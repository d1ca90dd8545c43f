// Options that no method can follow are refused when the stage is made, or, in
// float, when it begins.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "optimizers/classical.h"
#include "optimizers/half_inverse_direct.h"
#include "optimizers/jpo.h"
#include "optimizers/steps/rule_check.h"
#include "optimizers/training.h"
#include "optimizers/training/newton.h"
#include "suite/core/check.h"

namespace physinv {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(MethodOptions, UpdateRules) {
  const std::vector<StepOptions> good = {AdamOptions{},
                                         SgdOptions{.rate = 0},
                                         AdagradOptions{.accumulator = 0},
                                         AdadeltaOptions{},
                                         RmspropOptions{}};
  for (const StepOptions& o : good) {
    EXPECT_NO_THROW(check_rule<float>(o));
    EXPECT_NO_THROW(check_rule<double>(o));
  }
  const std::vector<StepOptions> bad = {AdamOptions{.rate = kNan},
                                        AdamOptions{.rate = kInf},
                                        AdamOptions{.rate = -1},
                                        AdamOptions{.beta1 = 1},
                                        AdamOptions{.beta2 = -0.1},
                                        AdamOptions{.beta2 = kNan},
                                        AdamOptions{.eps = -1},
                                        SgdOptions{.rate = kNan},
                                        SgdOptions{.momentum = 1},
                                        SgdOptions{.momentum = kNan},
                                        AdagradOptions{.accumulator = -1},
                                        AdagradOptions{.eps = kNan},
                                        AdadeltaOptions{.decay = 1},
                                        AdadeltaOptions{.rate = -1},
                                        RmspropOptions{.decay = kNan},
                                        RmspropOptions{.eps = -1}};
  for (std::size_t i = 0; i < bad.size(); ++i) {
    EXPECT_THROW(check_rule<float>(bad[i]), ContractError) << i;
    EXPECT_THROW(check_rule<double>(bad[i]), ContractError) << i;
    EXPECT_THROW(train({.rule = bad[i]}), ContractError) << i;
    EXPECT_THROW(jpo_fit({.step = bad[i]}), ContractError) << i;
  }
  // Numbers in double, none or 0 in float.
  for (const double far : {1e100, 1e-100}) {
    EXPECT_NO_THROW(check_rule<double>(SgdOptions{.rate = far}));
    EXPECT_THROW(check_rule<float>(SgdOptions{.rate = far}), ContractError);
    EXPECT_THROW(check_rule<float>(AdamOptions{.eps = far}), ContractError);
  }
}

TEST(MethodOptions, Training) {
  const auto expect_refused = [](const TrainingOptions& o, int line) {
    EXPECT_THROW(train(o), ContractError) << "line " << line;
  };
  EXPECT_NO_THROW(train({}));
  expect_refused({.batch = 0}, __LINE__);
  expect_refused({.batch = -1}, __LINE__);
  expect_refused({.chunk = -1}, __LINE__);
  expect_refused({.iterations = -1}, __LINE__);
  expect_refused({.gradient_scale = kNan}, __LINE__);
  expect_refused({.set = -1}, __LINE__);
  using Half = HalfInverseStepOptions;
  expect_refused({.rule = Half{.power = {.kappa = -1.5}}}, __LINE__);
  expect_refused({.rule = Half{.power = {.kappa = kNan}}}, __LINE__);
  expect_refused({.rule = Half{.power = {.tau = -1}}}, __LINE__);
  expect_refused({.rule = Half{.power = {.beta = kNan}}}, __LINE__);
  expect_refused({.rule = Half{.rate = kNan}}, __LINE__);
  expect_refused({.rule = Half{.numerics = {.tolerance = kNan}}}, __LINE__);
  expect_refused({.rule = AdaHessianOptions{.rate = kNan}}, __LINE__);
  expect_refused({.rule = AdaHessianOptions{.power = -1}}, __LINE__);
  expect_refused({.rule = AdaHessianOptions{.beta1 = kNan}}, __LINE__);
  using Free = HessianFreeOptions;
  expect_refused({.rule = Free{.rate = kNan}}, __LINE__);
  expect_refused({.rule = Free{.damping = -1}}, __LINE__);
  expect_refused({.rule = Free{.warm = kNan}}, __LINE__);
  expect_refused({.rule = Free{.solver = {.iterations = 0}}}, __LINE__);
  expect_refused({.rule = Free{.solver = {.residual = kNan}}}, __LINE__);
}

TEST(MethodOptions, TheOthers) {
  for (const double clip : {kNan, -0.1, 1.1})
    EXPECT_THROW(jpo_fit({.clip = clip}), ContractError);
  EXPECT_THROW(jpo_fit({.iterations = -1}), ContractError);
  EXPECT_THROW(newton_proxy({.damping = kNan}), ContractError);
  EXPECT_THROW(newton_proxy({.limit = kNan}), ContractError);
  EXPECT_THROW(newton_proxy({.limit = 0}), ContractError);
  EXPECT_THROW(bfgs_solve({.stall = kNan}), ContractError);
  EXPECT_THROW(bfgs_refine({.search_evaluations = -1}), ContractError);
  EXPECT_THROW(half_inverse_direct({.power = {.tau = kNan}}), ContractError);
  EXPECT_THROW(half_inverse_direct({.rate = kInf}), ContractError);
  EXPECT_THROW(half_inverse_direct({.iterations = -1}), ContractError);
}

}  // namespace
}  // namespace physinv
