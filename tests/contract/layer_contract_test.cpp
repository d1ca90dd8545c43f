// The networks of every registered experiment, as it configures them. Single
// layers and activations: tests/suite/nn.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>

#include "optimizers/network_model.h"
#include "suite/harness/study.h"
#include "tests/support/gradient_check.h"
#include "tests/support/registered.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

/// Parameters as printed, of predictor and surrogate.
const std::map<std::string, std::array<Index, 2>> kParameters = {
    {"hig/quantum-dipole", {9484, 0}},
    {"hig/quantum-dipole-cnn", {21984, 0}},
    {"jpo/billiards", {37506, 37506}},
    {"jpo/kuramoto-sivashinsky", {59650, 13121}},
    {"jpo/navier-stokes", {44723, 38290}},
    {"jpo/robotic-arm", {33924, 33922}},
    {"jpo/wave-packet", {13921, 13073}},
    {"sip/fluid", {49570, 0}},
    {"sip/heat", {37697, 0}},
    {"sip/wave-packet", {17489, 0}}};

struct Role {
  ExperimentPtr experiment;
  bool surrogate;
};
void PrintTo(const Role& r, std::ostream* out) { *out << r.experiment->name; }

/// A study's networks are those of what it varies, unless it varies them.
std::vector<Role> roles() {
  std::vector<Role> all;
  std::set<std::tuple<std::string, std::string, bool>> seen;
  for (const auto& e : registry().experiments())
    for (const bool surrogate : {false, true}) {
      const NetworkRecipe& recipe =
          (surrogate ? e->setting.surrogate : e->setting.predictor).recipe;
      if (!recipe.make_double) continue;
      const bool is_new =
          seen.emplace(recipe.description, e->problem.name, surrogate).second;
      if (is_new || !studies().contains(e->name)) all.push_back({e, surrogate});
    }
  return all;
}

class LayerContract : public testing::TestWithParam<Role> {
 protected:
  LayerContract() {
    const auto& experiment = *GetParam().experiment;
    const auto problem = experiment.problem.make<double>();
    const auto& setting = experiment.setting;
    role_ = GetParam().surrogate ? setting.surrogate : setting.predictor;
    const Shape shape = problem->shape();
    net_ = role_.recipe.make<double>(
        input_rows(role_.inputs, shape),
        GetParam().surrogate ? shape.observations : shape.unknowns);
    const auto s =
        problem->sample_labelled(0, kCount, Rng::root("layer_contract", 1));
    in_ = assemble<double>(role_.inputs, s.x, s.given, s.y);
    p_.resize(net_->parameter_count());
    state_.resize(net_->state_count());
    net_->initialize(Rng::root("layer_contract", 2), p_, state_);
    for (Index i = 0; i < p_.size(); ++i)
      p_(i) += 0.05 * std::cos(0.9 * double(i));
    out_bar_ = Batch<double>::NullaryExpr(
        net_->outputs(), kCount, [](Index i, Index j) {
          return std::sin(1.7 * double(i) + 0.6 * double(j) + 1);
        });
  }

  Batch<double> forward(const Vector<double>& p,
                        const Batch<double>& in,
                        Pass pass = {}) {
    Batch<double> out(net_->outputs(), in.cols());
    net_->forward(p, state_, in, out, tape_, work_, pass);
    return out;
  }
  double value(const Vector<double>& p, const Batch<double>& in, Pass pass) {
    return (forward(p, in, pass).array() * out_bar_.array()).sum();
  }

  static constexpr Index kCount = 5;
  NetworkRole role_;
  std::unique_ptr<Network<double>> net_;
  Batch<double> in_, out_bar_;
  Vector<double> p_, state_;
  Tape tape_;
  Workspace work_;
};

TEST_P(LayerContract, HasTheParametersOfThePaper) {
  Index sum = 0;
  for (const TensorInfo& t : net_->tensors()) {
    EXPECT_EQ(t.offset, sum) << t.name;
    EXPECT_GT(t.size, 0) << t.name;
    EXPECT_GT(t.fan_in, 0) << t.name;
    sum += t.size;
  }
  EXPECT_EQ(sum, net_->parameter_count());
  const auto printed = kParameters.find(GetParam().experiment->name);
  if (printed != kParameters.end()) {
    EXPECT_EQ(sum, printed->second[GetParam().surrogate ? 1 : 0]);
  }
}

TEST_P(LayerContract, GradientsAgreeWithCentralDifferences) {
  if (net_->operations() > 2e7)
    GTEST_SKIP() << "its layers are looked at on smaller planes";
  for (const bool training : {false, true}) {
    const Pass pass{.training = training, .fixed_input = training};
    Vector<double> p_bar(p_.size());
    Batch<double> in_bar(in_.rows(), kCount);
    VectorOut<double> p_ref(p_bar);
    BatchOut<double> in_ref(in_bar);
    forward(p_, in_, pass);
    net_->backward(p_, tape_, out_bar_, &p_ref, &in_ref, work_);

    // Every tensor's first, middle and last entries, and inputs here and there.
    Index checked = 0, asked = 0;
    const double h = 1e-6;
    const auto expect_slope = [&](double& at, double bar, const auto& name) {
      const double old = at;
      const auto slope = [&](double step) {
        at = old + step;
        const double up = value(p_, in_, pass);
        at = old - step;
        const double down = value(p_, in_, pass);
        at = old;
        return (up - down) / (2 * step);
      };
      const double d = slope(h);
      if (std::abs(d - slope(4 * h)) > 1e-6 * (1 + std::abs(d))) return;
      ++checked;
      EXPECT_NEAR(bar, d, 1e-6 * (1 + std::abs(d))) << name;
    };
    for (const TensorInfo& t : net_->tensors()) {
      for (const Index k : {Index{0}, t.size / 2, t.size - 1}) {
        expect_slope(p_(t.offset + k), p_bar(t.offset + k), t.name);
        ++asked;
      }
    }
    const Index apart = std::max<Index>(1, in_.size() / 50);
    for (Index i = 0; i < in_.size(); i += apart, ++asked)
      expect_slope(in_(i), in_bar(i), "input");
    EXPECT_GE(checked, asked / 2) << "too many kinks";

    // All at once: the directional derivative in parameters and inputs.
    const Vector<double> p_dot = Vector<double>::NullaryExpr(
        p_.size(), [](Index i) { return std::cos(1.3 * double(i)); });
    const Batch<double> in_dot = out_bar_(0, 0) * in_;
    const double step = 1e-7;
    const double pushed =
        (value(p_ + step * p_dot, in_ + step * in_dot, pass) -
         value(p_ - step * p_dot, in_ - step * in_dot, pass)) /
        (2 * step);
    const double pulled =
        p_bar.dot(p_dot) + (in_bar.array() * in_dot.array()).sum();
    EXPECT_NEAR(pulled, pushed, 1e-5 * (1 + std::abs(pushed)));
  }
}

// Forward mode is the transpose of backward, its own reverse is symmetric.
TEST_P(LayerContract, TangentsAgreeWithBackward) {
  for (const bool training : {false, true}) {
    const Batch<double> out =
        forward(p_, in_, {.training = training, .fixed_input = training});
    const Vector<double> u = Vector<double>::NullaryExpr(
        p_.size(), [](Index i) { return std::cos(1.3 * double(i)); });
    const Vector<double> v = Vector<double>::NullaryExpr(
        p_.size(), [](Index i) { return std::sin(0.7 * double(i) + 1); });
    Tape dots;
    const auto tangent = [&](const Vector<double>& p_dot) {
      Batch<double> out_dot(out.rows(), kCount);
      net_->tangent(
          p_, tape_, p_dot, Batch<double>(in_.rows(), 0), out_dot, dots, work_);
      return out_dot;
    };
    Vector<double> p_bar(p_.size());
    VectorOut<double> ref(p_bar);
    net_->backward(p_, tape_, out_bar_, &ref, nullptr, work_);
    Batch<double> u_dot;
    try {
      u_dot = tangent(u);
    } catch (const std::exception& e) {
      ASSERT_NE(std::string(e.what()).find("no forward mode"),
                std::string::npos)
          << e.what();
      GTEST_SKIP() << "has layers without forward mode";
    }
    EXPECT_NEAR((u_dot.array() * out_bar_.array()).sum(),
                p_bar.dot(u),
                1e-11 * u_dot.norm() * out_bar_.norm());

    // The Hessian of half the square of the output.
    const auto product = [&](const Vector<double>& p_dot) {
      const Batch<double> out_dot = tangent(p_dot);
      Vector<double> bar(p_.size());
      net_->backward_tangent(
          p_, tape_, p_dot, dots, out, out_dot, nullptr, bar, work_);
      return bar;
    };
    const Vector<double> hu = product(u), hv = product(v);
    EXPECT_NEAR(u.dot(hv), v.dot(hu), 1e-11 * u.norm() * hv.norm());
  }
}

TEST_P(LayerContract, FloatAgreesWithDouble) {
  const auto single = role_.recipe.make<float>(net_->inputs(), net_->outputs());
  const Vector<float> p = p_.cast<float>(), s = state_.cast<float>();
  Batch<float> out(net_->outputs(), kCount);
  Tape tape;
  Workspace work;
  single->forward(p, s, in_.cast<float>(), out, tape, work);
  EXPECT_TRUE(Comparator(Tolerance<float>::relative, 0)(out, forward(p_, in_)));
}

// What recorded losses are checked with.
TEST_P(LayerContract, PlainLoopsAgree) {
  Vector<double> out;
  if (!net_->evaluate_plainly(p_, in_.col(0), out))
    GTEST_SKIP() << "has layers without plain loops";
  const Batch<double> expected = forward(p_, in_);
  for (Index i = 0; i < kCount; ++i) {
    ASSERT_TRUE(net_->evaluate_plainly(p_, in_.col(i), out));
    EXPECT_TRUE(Comparator(1e-12, 1e-13)(out, Vector<double>(expected.col(i))));
  }
}

INSTANTIATE_TEST_SUITE_P(Registered,
                         LayerContract,
                         testing::ValuesIn(roles()),
                         [](const testing::TestParamInfo<Role>& at) {
                           return test_name(at.param.experiment->name) +
                                  (at.param.surrogate ? "_surrogate"
                                                      : "_predictor");
                         });

}  // namespace
}  // namespace physinv::test
