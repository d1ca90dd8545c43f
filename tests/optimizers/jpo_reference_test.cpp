// Entry jpo_mlp of jpo-billiards. And: no entry of the file is without a test.

#include "tests/support/jpo_reference.h"

#include "problems/billiards/billiards.h"
#include "suite/nn/mlp.h"

namespace physinv::test {
namespace {

const std::string kId = "jpo-billiards";

void check_in(const Json& entry, Precision precision) {
  const auto sizes = layer_sizes(entry, {32, 128, 128, 128, 2});
  const Batch<double> balls = columns(entry.at("balls"), 2);
  const auto target = BilliardsOptions{}.target;
  Samples<double> s{{}, Batch<double>(2, balls.cols()), balls};
  s.y.colwise() = Eigen::Vector2d(target[0], target[1]);
  expect_jpo(
      kId,
      entry,
      {.inputs = {Field::given, Field::observations},
       .network = nn::mlp({.hidden = {sizes.begin() + 1, sizes.end() - 1},
                           .frequencies = sizes.front() / 8}),
       .rate = 1e-4,
       .last_matrix = 0.05},
      problems::billiards(),
      s,
      precision);
}

TEST(JpoReference, InBothPrecisions) {
  check_entries_named(
      kId,
      "jpo_mlp",
      in_both([](const Json& e) { check_in(e, Precision::f32); },
              [](const Json& e) { check_in(e, Precision::f64); }));
}

TEST(JpoReference, EveryEntryOfTheFileHasATest) {
  expect_known_entries(kId,
                       {"clip_percentile_*",
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
