// The vectors of sip-heat that are training: through the stage itself, on
// listed observations and from listed weights.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "optimizers/training.h"
#include "optimizers/training/proxy.h"
#include "problems/heat/heat.h"
#include "suite/nn/unet.h"
#include "tests/support/bits.h"
#include "tests/support/listed.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kHeatId = "sip-heat";

Index side_of(const Batch<double>& y) {
  const auto side = Index(std::lround(std::sqrt(double(y.rows()))));
  if (side * side != y.rows())
    throw std::runtime_error("fields of " + std::to_string(y.rows()) +
                             " cells, expected squares");
  return side;
}

/// Heat on a list of observations.
ProblemRecipe observed(const Batch<double>& y) {
  return with_samples(problems::heat({.resolution = side_of(y)}),
                      {y, y, Batch<double>(0, y.cols())});
}

Setting heat_setting(Index side) {
  const auto net = nn::unet({.grid = {side, side},
                             .padding = nn::Padding::circular,
                             .batch_statistics = true});
  return {.predictor = {{Field::observations}, net},
          .output_form = OutputForm::mean_of_observations};
}

/// The same on every grid.
const std::vector<TensorInfo>& net_tensors() {
  static const auto net =
      heat_setting(16).predictor.recipe.make<double>(256, 256);
  return net->tensors();
}

Batch<double> heat_weights(const Json& rule) {
  return recurrence_weights(rule, net_tensors());
}

/// The entry's own batch, or the one that it names.
Batch<double> observations(const Json& entry) {
  return fields(batch_of(kHeatId, entry.at("inputs").at("y_star"), "y_star"));
}

Outcome train_on(const Json& rule,
                 const Batch<double>& y,
                 Index updates,
                 const StepOptions& step,
                 bool sip,
                 Precision precision) {
  const auto stage =
      train({.rule = step,
             .batch = y.cols(),
             .gradient_scale = double(y.cols()),
             .signal = sip ? inverse_proxy(ProxyNorm::square,
                                           ProxyPrecision::in_double)
                           : solver_loss()});
  StageBench bench(
      *stage, y.cols(), updates, observed(y), heat_setting(side_of(y)));
  Outcome before;
  before.arrays["parameters"] = heat_weights(rule);
  before.arrays["state"] = Batch<double>(0, 1);
  return bench.run(&before, precision);
}

/// Single precision has its own rounding to lose: of y* and of the network.
Comparator heat_tolerance(const Json& entry, Precision precision) {
  const Comparator exact = EntryTolerance(entry.at("tolerance")).array();
  if (precision == Precision::f64) return exact;
  return {2e-3, exact.atol()};
}

bool is_sip(const Json& entry) {
  const std::string method = entry.at("inputs").at("method");
  if (method == "sip") return true;
  if (method == "l2") return false;
  throw std::runtime_error("inputs.method is " + method +
                           ", the test knows l2 and sip");
}

/// A step of length one is the gradient.
void check_training_gradient(const Json& entry) {
  const Json want = entry.at("expected");
  const Json rule = entry.at("inputs").at("weights");
  const Batch<double> y = observations(entry);
  const bool sip = is_sip(entry);
  for (const Precision p : {Precision::f64, Precision::f32}) {
    const auto same = heat_tolerance(entry, p);
    const StepOptions step = SgdOptions{.rate = 1};
    const Outcome before = train_on(rule, y, 0, step, sip, p);
    // All of the prediction, or its first row.
    const Json prediction = want.at("prediction");
    if (prediction.front().is_array()) {
      EXPECT_TRUE(same(before.x, fields(prediction)));
    } else {
      const Vector<double> row = vector(prediction);
      ASSERT_LE(row.size(), before.x.rows());
      EXPECT_TRUE(same(before.x.col(0).head(row.size()), row));
    }

    const Outcome after = train_on(rule, y, 1, step, sip, p);
    const double loss =
        after.arrays.at("batch_loss")(0, 0) * double(after.x.cols());
    EXPECT_TRUE(same(loss, number(want.at("loss"))));
    const Vector<double> g =
        (heat_weights(rule) - after.arrays.at("parameters")).col(0);
    EXPECT_TRUE(same(tensor_norms(net_tensors(), g),
                     vector(want.at("gradient_norms"))));
  }
}

/// By the end of the entry's name; rates as in its description.
struct NamedRule {
  explicit NamedRule(const Json& entry) {
    const std::string name = entry.at("name");
    const auto rate = [&](const char* words, double specified) {
      const double stated = setting(entry, "lr", words, specified);
      longer = std::max(1.0, stated / specified);
      return stated;
    };
    if (name.ends_with("-sgd"))
      step = SgdOptions{.rate = rate("sgd lr ", 2e-4)};
    else if (name.ends_with("-adam") || name.ends_with("-sip"))
      step = AdamOptions{.rate = rate("Adam (?:lr )?", 1e-3), .eps = 1e-8};
    else
      throw std::runtime_error("no test knows the method of " + name);
  }
  StepOptions step;
  double longer = 1;  ///< than the specification's steps
};

/// After every step: norm and first entries of the prediction.
void check_two_steps(const Json& entry) {
  const Batch<double> after = columns(entry.at("expected").at("after_step"));
  const bool sip = entry.at("name").get<std::string>().ends_with("-sip");
  const Json rule = entry.at("inputs").at("weights");
  const Batch<double> y = observations(entry);
  const NamedRule rule_of(entry);
  const Index first = after.rows() - 1;
  ASSERT_TRUE(1 <= first && first <= y.rows());
  for (const Precision p : {Precision::f64, Precision::f32}) {
    const auto same = heat_tolerance(entry, p);
    for (Index k = 1; k <= after.cols(); ++k) {
      const Outcome out = train_on(rule, y, k, rule_of.step, sip, p);
      EXPECT_TRUE(same(out.x.norm(), after(0, k - 1))) << k;
      // Float loses more in more and longer steps than two of the
      // specification's, and that of the whole output.
      const double further = rule_of.longer * std::max(1.0, double(k) / 2) - 1;
      const double lost = p == Precision::f64
                              ? 0
                              : 2e-3 * out.x.cwiseAbs().maxCoeff() * further;
      EXPECT_TRUE(Comparator(same.rtol(), same.atol() + lost)(
          out.x.col(0).head(first), after.col(k - 1).tail(first)))
          << k;
    }
  }
}

// Where the network is in double already, nothing is rounded on the way.
TEST(Proxy, InDoubleIsTheSameForNetworksInDouble) {
  const Batch<double> y = observations(spoken_of(kHeatId, "training-gradient"));
  const auto after = [&](ProxyPrecision precision) {
    const auto stage =
        train({.rule = SgdOptions{.rate = 1e-3},
               .batch = 1,
               .signal = inverse_proxy(ProxyNorm::square, precision)});
    StageBench bench(
        *stage, y.cols(), 4, observed(y), heat_setting(side_of(y)));
    return Batch<double>(bench.run().arrays.at("parameters"));
  };
  EXPECT_TRUE(same_bits(after(ProxyPrecision::of_network),
                        after(ProxyPrecision::in_double)));
}

TEST(SipHeatReference, Training) {
  check_entries(kHeatId,
                {{"training-gradient-*", check_training_gradient},
                 {"two-steps-*", check_two_steps}},
                {"kernel",
                 "rectangles",
                 "forward",
                 "gd-closed-form",
                 "inverse-physics-iteration",
                 "inverse-step-*"});
}

}  // namespace
}  // namespace physinv::test
