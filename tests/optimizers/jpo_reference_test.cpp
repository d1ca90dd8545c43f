// Entry jpo_mlp of jpo-billiards. And: no entry of the file is without a test.

#include "tests/support/jpo_reference.h"

#include "problems/billiards/billiards.h"
#include "suite/nn/mlp.h"

namespace physinv::test {
namespace {

void run_entries(Precision precision) {
  const auto entries = reference_entries("jpo-billiards", "jpo_mlp");
  ASSERT_FALSE(entries.empty());
  for (const Json& entry : entries) {
    const Batch<double> balls = columns(entry.at("balls"));
    const auto target = BilliardsOptions{}.target;
    Samples<double> s{{}, Batch<double>(2, balls.cols()), balls};
    s.y.colwise() = Eigen::Vector2d(target[0], target[1]);
    expect_jpo<Billiards>(
        entry,
        {.inputs = {Field::given, Field::observations},
         .network = nn::mlp({.hidden = {128, 128, 128}, .frequencies = 4}),
         .parameters = 37506,
         .rate = 1e-4,
         .last_matrix = 0.05},
        s,
        precision);
  }
}

TEST(JpoReference, Double) { run_entries(Precision::f64); }

TEST(JpoReference, FirstStepInFloat) { run_entries(Precision::f32); }

TEST(JpoReference, EveryEntryOfTheFileHasATest) {
  expect_known_entries("jpo-billiards",
                       {"clip_percentile_90",
                        "boundary_loss",
                        "bfgs_test_functions",
                        "simulate",
                        "bfgs",
                        "gd_adaptive",
                        "encoding",
                        "jpo_mlp"});
}

}  // namespace
}  // namespace physinv::test
