// Stages that store the solutions of some examples alone: the others are made
// again from the network's parameters.
#include "suite/harness/verify.h"

#include <gtest/gtest.h>

#include "suite/harness/keys.h"
#include "tests/support/registered.h"

namespace physinv::test {
namespace {

class VerifyByNetwork : public testing::TestWithParam<const char*> {
 protected:
  VerifyByNetwork() {
    const Case c = small_case(
        registry().find(GetParam()), "adam", kCount, 3, Precision::f64);
    record_ = {.info = c.info, .data = draw_data(c), .stages = run(c)};
  }
  VerifyReport verify() const {
    return verify_results(Results({record_}), registry());
  }
  StageRecord& stage() { return record_.stages.back(); }
  double& last_of(ArrayKey array) {
    auto& values = stage().arrays.at(array);
    return values.data()[values.size() - 1];
  }

  static constexpr Index kCount = 40;
  CaseRecord record_;
};

TEST_P(VerifyByNetwork, EveryLossAndTheirMean) {
  ASSERT_LT(stage().x.cols(), kCount);
  const VerifyReport report = verify();
  EXPECT_EQ(report.mismatches, std::vector<std::string>());
  EXPECT_EQ(report.losses, std::size_t{kCount + 1});
  EXPECT_EQ(report.by_network,
            static_cast<std::size_t>(kCount + 1 - stage().x.cols()));
  EXPECT_EQ(report.not_again, 0U);
}

TEST_P(VerifyByNetwork, OneWrongLossOrMean) {
  stage().loss(kCount - 1) *= 1 + 1e-6;
  EXPECT_EQ(verify().mismatches.size(), 1U);
  last_of("mean_loss") *= 1 + 1e-6;
  EXPECT_EQ(verify().mismatches.size(), 2U);
}

TEST_P(VerifyByNetwork, OneWrongParameter) {
  last_of("parameters") += 1e-3;
  EXPECT_GT(verify().mismatches.size(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Registered,
                         VerifyByNetwork,
                         testing::Values("hig/toy-gamma-1",
                                         "hig/oscillators",
                                         "hig/poisson",
                                         "hig/quantum-dipole",
                                         "hig/quantum-dipole-cnn"),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace physinv::test
