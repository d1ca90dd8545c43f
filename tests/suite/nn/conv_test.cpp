// Layers on fields, one by one, against their definitions.

#include "suite/nn/conv.h"

#include <gtest/gtest.h>

#include <cmath>

#include "suite/nn/activation.h"
#include "suite/nn/rearrange.h"
#include "suite/nn/resample.h"
#include "suite/nn/sequential.h"
#include "suite/nn/skip.h"
#include "tests/suite/nn/nn_testing.h"

namespace physinv::nn {
namespace {

template <class T>
Bench<T> bench(const NetworkRecipe& recipe) {
  return Bench<T>(recipe, 0, 0);
}

double tolerance(float) { return 2e-5; }
double tolerance(double) { return 1e-12; }

struct Case {
  ConvOptions options;
  Index n;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const std::vector<std::pair<Grid, Taps>> fields = {{{16, 1}, {3, 1}},
                                                     {{7, 1}, {5, 1}},
                                                     {{2, 1}, {5, 1}},
                                                     {{1, 1}, {3, 1}},
                                                     {{9, 1}, {1, 1}},
                                                     {{6, 5}, {3, 3}},
                                                     {{3, 7}, {5, 3}},
                                                     {{2, 2}, {3, 5}}};
  for (const auto& [grid, taps] : fields)
    for (const Padding padding :
         {Padding::zero, Padding::circular, Padding::none}) {
      if (padding == Padding::none && (!grid.flat() || grid.columns < taps.x))
        continue;
      for (const auto& [in, out, n] : {std::array<Index, 3>{1, 16, 8},
                                       std::array<Index, 3>{3, 5, 37},
                                       std::array<Index, 3>{5, 2, 1},
                                       std::array<Index, 3>{4, 11, 21}})
        all.push_back({{.grid = grid,
                        .in = in,
                        .out = out,
                        .taps = taps,
                        .padding = padding},
                       n});
    }
  return all;
}

/// Calls f(output row, input row, index of the weight) for every product.
template <class F>
void for_products(const ConvOptions& o, F&& f) {
  const auto wrap = [](Index i, Index n) { return ((i % n) + n) % n; };
  const Grid to = window_output(o.grid, o.taps, o.padding);
  const Index shift = o.padding == Padding::none ? o.taps.x / 2 : 0;
  for (Index r = 0; r < to.rows; ++r)
    for (Index c = 0; c < to.columns; ++c)
      for (Index ty = 0; ty < o.taps.y; ++ty)
        for (Index tx = 0; tx < o.taps.x; ++tx) {
          Index rr = r + ty - o.taps.y / 2, cc = c + shift + tx - o.taps.x / 2;
          if (o.padding == Padding::circular) {
            rr = wrap(rr, o.grid.rows), cc = wrap(cc, o.grid.columns);
          } else if (rr < 0 || cc < 0 || rr >= o.grid.rows ||
                     cc >= o.grid.columns) {
            continue;
          }
          for (Index i = 0; i < o.in; ++i)
            for (Index q = 0; q < o.out; ++q)
              f((r * to.columns + c) * o.out + q,
                (rr * o.grid.columns + cc) * o.in + i,
                (q * o.in + i) * o.taps.count() + ty * o.taps.x + tx);
        }
}

template <class T>
class ConvTest : public testing::Test {};
using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(ConvTest, Types);

TYPED_TEST(ConvTest, AgreesWithTheDirectSum) {
  using T = TypeParam;
  for (const auto& [options, n] : cases()) {
    const ConvOptions o = options;
    auto b = bench<T>(network([o]<class U>() { return layers(conv<U>(o)); }));
    const Index outputs =
        window_output(o.grid, o.taps, o.padding).positions() * o.out;
    const Batch<T> in = wavy<T>(o.grid.positions() * o.in, n);
    const Batch<T> out_bar = wavy<T>(outputs, n, 0.4);
    const Batch<double> x = in.template cast<double>();
    const Batch<double> y_bar = out_bar.template cast<double>();
    Batch<double> y(outputs, n), x_bar = 0 * x;
    Vector<double> p_bar = Vector<double>::Zero(b.p.size());
    const Index weights = o.in * o.out * o.taps.count();
    for (Index i = 0; i < y.rows(); ++i) {
      y.row(i).setConstant(double(b.p(weights + i % o.out)));
      p_bar(weights + i % o.out) += y_bar.row(i).sum();
    }
    for_products(o, [&](Index to, Index from, Index w) {
      y.row(to) += double(b.p(w)) * x.row(from);
      x_bar.row(from) += double(b.p(w)) * y_bar.row(to);
      p_bar(w) += y_bar.row(to).dot(x.row(from));
    });
    const auto expect_near = [&, n = n](const auto& a, const auto& expected) {
      EXPECT_LE((a.template cast<double>() - expected).cwiseAbs().maxCoeff(),
                tolerance(T()) * (1 + expected.cwiseAbs().maxCoeff()))
          << o.grid.columns << "x" << o.grid.rows << " taps " << o.taps.x << "x"
          << o.taps.y << " " << o.in << "->" << o.out << " n=" << n;
    };
    expect_near(b.forward(in), y);
    expect_near(b.parameters_bar(out_bar), p_bar);
    expect_near(b.in_bar(out_bar), x_bar);
  }
}

TYPED_TEST(ConvTest, PoolingTakesTheLargestAndTheFirstOfEquals) {
  using T = TypeParam;
  auto b = bench<T>(network([]<class U>() {
    return layers(max_pool<U>(Grid{4, 2}, 1));
  }));
  Batch<T> in(8, 2);
  in.col(0) << 1, 2, 5, 5, 4, 3, 5, 5;
  in.col(1) << -1, -1, -3, -4, -1, -1, -2, std::nan("");
  const Batch<T> out = b.forward(in);
  EXPECT_EQ(out(0, 0), T(4));
  EXPECT_EQ(out(1, 0), T(5));
  EXPECT_EQ(out(0, 1), T(-1));
  EXPECT_TRUE(std::isnan(out(1, 1)));
  Batch<T> bar(2, 2), expected = Batch<T>::Zero(8, 2);
  bar << 7, 8, 9, 0;
  expected(4, 0) = 7, expected(2, 0) = 9, expected(0, 1) = 8;
  expect_same_bits(b.in_bar(bar), expected);
}

TYPED_TEST(ConvTest, PoolingLeavesAnOddColumnAndRowOut) {
  using T = TypeParam;
  auto b = bench<T>(network([]<class U>() {
    return layers(max_pool<U>(Grid{3, 5}, 1));
  }));
  Batch<T> in(15, 1), expected = Batch<T>::Zero(15, 1);
  for (Index i = 0; i < 15; ++i) in(i) = static_cast<T>(i);
  const Batch<T> out = b.forward(in);
  ASSERT_EQ(out.rows(), 2);
  EXPECT_EQ(out(0), T(4));
  EXPECT_EQ(out(1), T(10));
  expected(4) = 2, expected(10) = 3;
  expect_same_bits(b.in_bar(Batch<T>{{2}, {3}}), expected);
}

TYPED_TEST(ConvTest, UpsamplingReachesAnOddExtent) {
  using T = TypeParam;
  auto b = bench<T>(network(
      []<class U>() { return layers(upsample<U>(Grid{3}, Grid{7}, 1)); }));
  Batch<T> in(3, 1);
  in << 14, 28, 0;
  const Batch<T> out = b.forward(in);
  // Source of output i: (i + 1/2) 3/7 - 1/2.
  const std::vector<double> expected = {14, 16, 22, 28, 16, 4, 0};
  for (Index i = 0; i < 7; ++i)
    EXPECT_NEAR(
        out(i), expected[static_cast<std::size_t>(i)], 10 * tolerance(T()));
  const Batch<T> bar = wavy<T>(7, 1), x_bar = b.in_bar(bar);
  EXPECT_NEAR((x_bar.array() * in.array()).sum(),
              (bar.array() * out.array()).sum(),
              50 * tolerance(T()));
}

TYPED_TEST(ConvTest, UpsamplingClampsItsEnds) {
  using T = TypeParam;
  auto line = bench<T>(network(
      []<class U>() { return layers(upsample<U>(Grid{3}, Grid{6}, 1)); }));
  Batch<T> in(3, 1), expected(6, 1);
  in << 4, 8, 0;
  expected << 4, 5, 7, 6, 2, 0;
  expect_same_bits(line.forward(in), expected);
  auto point = bench<T>(network(
      []<class U>() { return layers(upsample<U>(Grid{1}, Grid{2}, 2)); }));
  expect_same_bits(point.forward(in.topRows(2)),
                   Batch<T>(in(std::vector<Index>{0, 1, 0, 1}, Eigen::all)));
  // On a plane, a product of lines: exact for a x + b y inside.
  auto plane = bench<T>(network([]<class U>() {
    return layers(upsample<U>(Grid{4, 3}, Grid{8, 6}, 1));
  }));
  const auto slope = [](Index columns, Index rows, double step, double first) {
    return Batch<T>::NullaryExpr(columns * rows, 1, [=](Index i, Index) {
      return static_cast<T>(8 * (first + step * double(i % columns)) +
                            16 * (first + step * double(i / columns)));
    });
  };
  const Batch<T> fine = plane.forward(slope(4, 3, 1, 0));
  const Batch<T> exact = slope(8, 6, 0.5, -0.25);
  for (Index r = 1; r < 5; ++r)
    for (Index c = 1; c < 7; ++c)
      EXPECT_NEAR(fine(8 * r + c), exact(8 * r + c), 1e-5);
  EXPECT_EQ(fine(0), T(0));
}

TYPED_TEST(ConvTest, FieldInputSpreadsNumbersAndFlattenTurnsBack) {
  using T = TypeParam;
  auto b = bench<T>(network([]<class U>() {
    return layers(field_input<U>({.positions = 3,
                                  .before = 1,
                                  .channels = 2,
                                  .after = 1,
                                  .shift = 1,
                                  .unit = 0.25}),
                  flatten<U>(3, 4));
  }));
  Batch<T> in(8, 1), expected(12, 1), bar(12, 1), in_bar(8, 1);
  in << 2, 10, 11, 12, 20, 21, 22, 0.5;
  expected << 4, 4, 4, 10, 11, 12, 20, 21, 22, -2, -2, -2;
  expect_same_bits(b.forward(in), expected);
  bar << 1, 2, 4, 10, 11, 12, 20, 21, 22, 3, 5, 7;
  in_bar << 28, 10, 11, 12, 20, 21, 22, 60;
  expect_same_bits(b.in_bar(bar), in_bar);
}

/// Conv - BN - f - pool, from the definitions, in double.
struct Naive {
  Naive(const ConvOptions& o, const Vector<double>& p, const Batch<double>& x)
      : mean(o.out), variance(o.out) {
    const Index weights = o.in * o.out * o.taps.count(), n = x.cols();
    z = Batch<double>(o.grid.positions() * o.out, n);
    for (Index i = 0; i < z.rows(); ++i)
      z.row(i).setConstant(p(weights + i % o.out));
    for_products(o, [&](Index to, Index from, Index w) {
      z.row(to) += p(w) * x.row(from);
    });
    count = double(o.grid.positions() * n);
    mean.setZero(), variance.setZero();
    for (Index i = 0; i < z.rows(); ++i) mean(i % o.out) += z.row(i).sum();
    mean /= count;
    for (Index i = 0; i < z.rows(); ++i)
      variance(i % o.out) +=
          (z.row(i).array() - mean(i % o.out)).square().sum();
    variance /= count;
    u = z;
    for (Index i = 0; i < z.rows(); ++i) {
      const Index c = i % o.out;
      u.row(i) = ((z.row(i).array() - mean(c)) / std::sqrt(variance(c) + 1e-5) *
                      p(weights + o.out + c) +
                  p(weights + 2 * o.out + c))
                     .max(0.0);
    }
  }
  Batch<double> z, u;
  Vector<double> mean, variance;
  double count = 0;
};

struct BlockCase {
  ConvOptions options;
  bool pool;
};

const std::vector<BlockCase> kBlocks = {
    {{.grid = {16}, .in = 2, .out = 5, .taps = {3, 1}}, true},
    {{.grid = {64}, .in = 3, .out = 16, .taps = {3, 1}}, false},
    {{.grid = {6, 4},
      .in = 2,
      .out = 3,
      .taps = {3, 3},
      .padding = Padding::circular},
     true},
    {{.grid = {5, 3}, .in = 1, .out = 4, .taps = {3, 3}}, false}};

NetworkRecipe block(const BlockCase& c, Activation f = Activation::relu) {
  return network(
      [=]<class U>() { return layers(conv_block<U>(c.options, f, c.pool)); });
}

TYPED_TEST(ConvTest, BlockFollowsTheFormulas) {
  using T = TypeParam;
  for (const auto& c : kBlocks) {
    const ConvOptions& o = c.options;
    const Index n = 21;
    auto b = bench<T>(block(c));
    Batch<T> in = wavy<T>(o.grid.positions() * o.in, n);
    in.array() += T(2);  // means far from zero
    const Naive naive(
        o, b.p.template cast<double>(), in.template cast<double>());
    const Batch<T> out = b.forward(in, {.training = true});
    const Index columns = o.grid.columns, half = columns / 2;
    for (Index i = 0; i < out.rows(); ++i) {
      const Index p = i / o.out, channel = i % o.out;
      const auto at = [&](Index q) { return naive.u.row(q * o.out + channel); };
      Eigen::RowVectorXd expected = at(p);
      if (c.pool && o.grid.flat()) {
        expected = at(2 * p).cwiseMax(at(2 * p + 1));
      } else if (c.pool) {
        const Index q = p / half * 2 * columns + p % half * 2;
        expected = at(q).cwiseMax(at(q + 1)).cwiseMax(
            at(q + columns).cwiseMax(at(q + columns + 1)));
      }
      EXPECT_LE(
          (out.row(i).template cast<double>() - expected).cwiseAbs().maxCoeff(),
          10 * tolerance(T()));
    }
    b.net->update_state(b.tape, b.s);
    for (Index k = 0; k < o.out; ++k) {
      EXPECT_NEAR(b.s(k), 0.1 * naive.mean(k), 10 * tolerance(T()));
      EXPECT_NEAR(
          b.s(o.out + k),
          0.9 + 0.1 * naive.variance(k) * naive.count / (naive.count - 1),
          10 * tolerance(T()));
    }
  }
}

/// Skip, pooling and upsampling around a block, on lines and planes. A skip
/// connection keeps the outputs of `ends_in_block`, not those of upsampling.
NetworkRecipe nested(bool plane, bool ends_in_block = false) {
  return network([=]<class U>() {
    const Grid grid = plane ? Grid{4, 4} : Grid{8}, half = halved(grid);
    const Taps taps = plane ? Taps{3, 3} : Taps{3, 1};
    const auto block = [&](Grid g, Index in, Index out, Activation f) {
      return conv_block<U>(
          {.grid = g, .in = in, .out = out, .taps = taps}, f, false);
    };
    auto inner = layers(max_pool<U>(grid, 3),
                        block(half, 3, 4, Activation::softplus),
                        upsample<U>(half, grid, 4));
    if (ends_in_block) inner.push_back(block(grid, 4, 4, Activation::sigmoid));
    return layers(block(grid, 2, 3, Activation::tanh),
                  skip<U>(grid.positions(), std::move(inner)),
                  block(grid, 7, 2, Activation::sigmoid),
                  conv<U>({.grid = grid, .in = 2, .out = 2, .taps = taps}),
                  activation_layer<U>(Activation::tanh, 2 * grid.positions()),
                  conv<U>({.grid = grid, .in = 2, .out = 1, .taps = {1, 1}}));
  });
}

void expect_central_differences(const NetworkRecipe& recipe, bool training) {
  auto b = bench<double>(recipe);
  const Index n = 3;
  const Pass pass{.training = training};
  Batch<double> in = wavy<double>(b.net->inputs(), n);
  const Batch<double> out_bar = wavy<double>(b.net->outputs(), n, 0.7);
  const auto value = [&] {
    return (b.forward(in, pass).array() * out_bar.array()).sum();
  };
  value();
  const Vector<double> p_bar = b.parameters_bar(out_bar);
  const Batch<double> in_bar = b.in_bar(out_bar);
  const double h = 1e-6;
  const auto slope = [&](double& at) {
    const double old = at;
    at = old + h;
    const double up = value();
    at = old - h;
    const double down = value();
    at = old;
    return (up - down) / (2 * h);
  };
  for (Index i = 0; i < b.p.size(); ++i)
    EXPECT_NEAR(p_bar(i), slope(b.p(i)), 2e-7 * (1 + std::abs(p_bar(i)))) << i;
  for (Index i = 0; i < in.size(); ++i)
    EXPECT_NEAR(in_bar(i), slope(in(i)), 2e-7 * (1 + std::abs(in_bar(i)))) << i;

  // <out_bar, J v> = <J^T out_bar, v> in a dense direction.
  const Batch<double> v = wavy<double>(in.rows(), n, 2.0);
  const Batch<double> kept = in;
  in = kept + h * v;
  const double up = value();
  in = kept - h * v;
  const double pushed = (up - value()) / (2 * h);
  EXPECT_NEAR((in_bar.array() * v.array()).sum(),
              pushed,
              1e-7 * (1 + std::abs(pushed)));
}

TEST(ConvGradient, OfBlocks) {
  for (const auto& c : kBlocks)
    for (const bool training : {false, true})
      expect_central_differences(
          block(c, c.pool ? Activation::relu : Activation::tanh), training);
}

TEST(ConvGradient, OfSkipsPoolingAndUpsampling) {
  for (const bool plane : {false, true})
    for (const bool training : {false, true})
      for (const bool ends_in_block : {false, true})
        expect_central_differences(nested(plane, ends_in_block), training);
}

TYPED_TEST(ConvTest, EvaluatedSamplesAreIndependentBitwise) {
  using T = TypeParam;
  for (const bool plane : {false, true}) {
    auto b = bench<T>(nested(plane));
    const Batch<T> in = wavy<T>(b.net->inputs(), 37);
    const Batch<T> out_bar = wavy<T>(b.net->outputs(), 37, 1.0);
    const Batch<T> out = b.forward(in), in_bar = b.in_bar(out_bar);
    for (const auto& some :
         {std::vector<Index>{3},
          std::vector<Index>{36, 0, 5, 17, 9},
          std::vector<Index>{
              8, 7, 6, 5, 4, 3, 2, 1, 0, 30, 31, 32, 33, 34, 35, 36, 20}}) {
      expect_same_bits(b.forward(Batch<T>(in(Eigen::all, some))),
                       Batch<T>(out(Eigen::all, some)));
      expect_same_bits(b.in_bar(Batch<T>(out_bar(Eigen::all, some))),
                       Batch<T>(in_bar(Eigen::all, some)));
    }
  }
}

}  // namespace
}  // namespace physinv::nn
