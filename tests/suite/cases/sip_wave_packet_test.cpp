// What the wave packet's claims read out of estimates and curves.
#include <gtest/gtest.h>

#include "suite/cases/sip/wave_packet/values.h"
#include "tests/suite/cases/hig_fixture.h"

namespace physinv::sip_wave_packet {

void add_claims(Registry&);

namespace {

constexpr const char* kName = "sip/wave-packet";

Batch<double> row(const std::vector<double>& values) {
  return Eigen::Map<const Batch<double>>(
      values.data(), 1, static_cast<Index>(values.size()));
}

/// Packets at 1, 12 and 45 from the start, estimated to lie at x.
CaseRecord planted(const char* method,
                   const std::vector<double>& x,
                   const std::vector<double>& loss,
                   StageRecord stage = trained("solve", {40, 10})) {
  stage.x = row(x);
  stage.loss = row(loss).transpose();
  stage.example_evaluations.setConstant(3, 6);
  CaseRecord c = chain(kName, method, {std::move(stage)});
  c.data.x = row({1, -12, 45});
  return c;
}

Verdict verdict(const std::vector<CaseRecord>& cases, const char* id) {
  return judged(add_claims, kName, cases, id).verdict;
}

TEST(SipWavePacket, DistancesDecideWhatLbfgsFinds) {
  const std::vector<double> loss = {2, 20, 30};
  const auto good = planted("lbfgs", {1.2, -12 + kPeriod + 2, 5}, loss);
  for (const char* id : {"P1", "P2", "P3"})
    EXPECT_EQ(verdict({good}, id), Verdict::reproduced) << id;
  const auto far = planted("lbfgs", {1.6, -12 + kPeriod + 2.3, 10}, loss);
  for (const char* id : {"P1", "P2", "P3"})
    EXPECT_EQ(verdict({far}, id), Verdict::not_reproduced) << id;
  // A packet that is found has not been missed by a period.
  const auto found = planted("lbfgs", {1, -12, 5}, loss);
  EXPECT_EQ(verdict({found}, "P2"), Verdict::not_reproduced);
}

TEST(SipWavePacket, TheNetworkIsHeldAgainstTheSameExamples) {
  const auto lbfgs = planted("lbfgs", {1, 0, 0}, {2, 20, 32});
  StageRecord curve = trained("train", {40, 30, 17});
  curve.arrays["metrics"] = Batch<double>::Constant(kMetricRows, 3, 7);
  const auto net = planted("net", {1, -12, 0}, {2, 3, 46}, curve);
  EXPECT_EQ(verdict({lbfgs, net}, "P4"), Verdict::reproduced);
  EXPECT_EQ(verdict({lbfgs, net}, "P6"), Verdict::reproduced);
  EXPECT_EQ(verdict({net}, "P5"), Verdict::not_judged);
  const auto better =
      judged(add_claims, kName, {lbfgs, net}, "A5").conditions.back();
  EXPECT_NEAR(*better.value, 1.0 / 3, 1e-12);

  const Results results({lbfgs, net});
  const Published published;
  const Evidence e{results, published, kName};
  EXPECT_NEAR(*median({"net"}, passes_lbfgs())(e).value, 18, 2);
  EXPECT_EQ(*median({"net"}, passes_lbfgs_error())(e).value, 0);
}

TEST(SipWavePacket, NothingRunIsNotJudged) {
  for (const char* id :
       {"P1", "P2", "P3", "P4", "P5", "P6", "A2", "A3", "A4a", "A5", "A6"})
    EXPECT_EQ(verdict({}, id), Verdict::not_judged) << id;
}

}  // namespace
}  // namespace physinv::sip_wave_packet
