// The vectors of sip-heat that are training: through the stage itself, on
// listed observations and from listed weights.
#include "optimizers/training.h"
#include "optimizers/training/proxy.h"
#include "problems/heat/heat.h"
#include "suite/nn/unet.h"
#include "tests/support/bits.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kHeatId = "sip-heat";
constexpr Index kSide = 16;

struct ObservedOptions {
  Batch<double> y;
};
Options describe(const ObservedOptions&) { return {}; }

/// Heat on a list of observations, whatever set is asked for.
template <class T>
class Observed final : public Heat<T> {
 public:
  using Options = ObservedOptions;
  explicit Observed(const Options& options = {})
      : Heat<T>({.resolution = kSide}), y_(options.y) {}

  Samples<double> sample(Index first, Index count, const Rng&) const override {
    const Batch<double> y = y_.middleCols(first, count);
    return {y, y, Batch<double>(0, count)};
  }

 private:
  Batch<double> y_;
};

Setting heat_setting() {
  const auto net = nn::unet({.grid = {kSide, kSide},
                             .padding = nn::Padding::circular,
                             .batch_statistics = true});
  return {.predictor = {{Field::observations}, net},
          .output_form = OutputForm::mean_of_observations};
}

std::vector<TensorInfo> tensors() {
  constexpr Index kCells = kSide * kSide;
  return heat_setting()
      .predictor.recipe.make<double>(kCells, kCells)
      ->tensors();
}

/// Parameters of one tensor after the other, all numbered in a row.
Batch<double> heat_weights(const Json& rule) {
  const auto at = [&](const char* key) { return rule.at(key).get<Index>(); };
  const auto all = tensors();
  EXPECT_EQ(all.size(), rule.at("order").size());
  Batch<double> weights(all.back().offset + all.back().size, 1);
  Index k = 0;
  for (const TensorInfo& t : all)
    for (Index i = 0; i < t.size; ++i, ++k) {
      const Index v = (at("a") * k * k + at("b") * k + at("c")) % at("m");
      const double u = 2.0 * double(v) / double(at("m") - 1) - 1;
      weights(t.offset + i) = t.kind == 's'   ? 1 + 0.1 * u
                              : t.kind == 'o' ? 0.1 * u
                                              : u / std::sqrt(double(t.fan_in));
    }
  EXPECT_EQ(k, 37'697);
  return weights;
}

Batch<double> observations() {
  const Json entry = reference_entries(kHeatId, "training-gradient-l2").at(0);
  const Json& fields = entry.at("inputs").at("y_star");
  Batch<double> y(kSide * kSide, Index(fields.size()));
  Index i = 0;
  for (const Json& field : fields)
    y.col(i++) = Batch<double>(rows(field).transpose()).reshaped();
  return y;
}

Outcome train_on(const Json& rule,
                 Index updates,
                 const StepOptions& step,
                 bool sip,
                 Precision precision) {
  const Batch<double> y = observations();
  const auto stage =
      train({.rule = step,
             .batch = y.cols(),
             .gradient_scale = double(y.cols()),
             .signal = sip ? inverse_proxy(ProxyNorm::square,
                                           ProxyPrecision::in_double)
                           : solver_loss()});
  StageBench bench(*stage,
                   y.cols(),
                   updates,
                   problem<Observed>("heat", {y}),
                   heat_setting());
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

void expect_heat_keys(const Json& want, const std::set<std::string>& known) {
  std::set<std::string> found;
  for (const auto& [key, value] : want.items()) found.insert(key);
  EXPECT_EQ(found, known);
}

/// A step of length one is the gradient.
void check_training_gradient(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  expect_heat_keys(want, {"prediction", "loss", "gradient_norms"});
  const Json& rule = in.at("weights");
  const bool sip = in.at("method") == "sip";
  for (const Precision p : {Precision::f64, Precision::f32}) {
    const auto same = heat_tolerance(entry, p);
    const StepOptions step = SgdOptions{.rate = 1};
    const Outcome before = train_on(rule, 0, step, sip, p);
    // Of the proxy's prediction only one row is stored.
    const Json& prediction = want.at("prediction");
    if (sip) {
      EXPECT_TRUE(same(before.x.col(0).head(kSide), vector(prediction)));
    } else {
      Batch<double> all = before.x;
      Index i = 0;
      for (const Json& field : prediction)
        all.col(i++) = Batch<double>(rows(field).transpose()).reshaped();
      EXPECT_TRUE(same(before.x, all));
    }

    const Outcome after = train_on(rule, 1, step, sip, p);
    const double loss =
        after.arrays.at("batch_loss")(0, 0) * double(after.x.cols());
    EXPECT_TRUE(same(loss, want.at("loss").get<double>()));
    const Batch<double> g = heat_weights(rule) - after.arrays.at("parameters");
    Vector<double> norms(Index(tensors().size()));
    Index t = 0;
    for (const TensorInfo& tensor : tensors())
      norms(t++) = g.col(0).segment(tensor.offset, tensor.size).norm();
    EXPECT_TRUE(same(norms, vector(want.at("gradient_norms"))));
  }
}

StepOptions rule_of(const std::string& name) {
  if (name == "two-steps-sgd") return SgdOptions{.rate = 2e-4};
  return AdamOptions{.rate = 1e-3, .eps = 1e-8};
}

void check_two_steps(const Json& entry) {
  const Json& want = entry.at("expected");
  expect_heat_keys(want, {"after_step"});
  const auto name = entry.at("name").get<std::string>();
  for (const Precision p : {Precision::f64, Precision::f32})
    for (Index k = 1; k <= 2; ++k) {
      const Outcome out = train_on(entry.at("inputs").at("weights"),
                                   k,
                                   rule_of(name),
                                   name == "two-steps-sip",
                                   p);
      Vector<double> seen(7);
      seen << out.x.norm(), out.x.col(0).head(6);
      const auto stored = vector(want.at("after_step").at(std::size_t(k - 1)));
      EXPECT_TRUE(heat_tolerance(entry, p)(seen, stored)) << k;
      EXPECT_TRUE(heat_tolerance(entry, p)(seen.tail(6), stored.tail(6)));
    }
}

// Where the network is in double already, nothing is rounded on the way.
TEST(Proxy, InDoubleIsTheSameForNetworksInDouble) {
  const auto after = [](ProxyPrecision precision) {
    const Batch<double> y = observations();
    const auto stage =
        train({.rule = SgdOptions{.rate = 1e-3},
               .batch = 1,
               .signal = inverse_proxy(ProxyNorm::square, precision)});
    StageBench bench(
        *stage, 2, 4, problem<Observed>("heat", {y}), heat_setting());
    return Batch<double>(bench.run().arrays.at("parameters"));
  };
  EXPECT_TRUE(same_bits(after(ProxyPrecision::of_network),
                        after(ProxyPrecision::in_double)));
}

TEST(SipHeatReference, Training) {
  check_entries(kHeatId,
                {{"training-gradient-l2", check_training_gradient},
                 {"training-gradient-sip", check_training_gradient},
                 {"two-steps-sgd", check_two_steps},
                 {"two-steps-adam", check_two_steps},
                 {"two-steps-sip", check_two_steps}},
                {"kernel",
                 "rectangles",
                 "forward",
                 "gd-closed-form",
                 "inverse-physics-iteration",
                 "inverse-step-random",
                 "inverse-step-diffused",
                 "inverse-step-diffused-floor"});
}

}  // namespace
}  // namespace physinv::test
