#include "suite/nn/fno.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "suite/core/threads.h"
#include "suite/nn/activation.h"
#include "suite/nn/spectral.h"
#include "tests/suite/nn/nn_testing.h"
#include "tests/support/tolerance.h"

namespace physinv::nn {
namespace {

FnoOptions small() {
  return {.grid = {5, 4},
          .padding = 2,
          .modes = 3,
          .width = 4,
          .blocks = 3,
          .hidden = 6};
}

TEST(Gelu, LanesAgreeWithTheLibrary) {
  const auto check = [](auto one, double tolerance) {
    using T = decltype(one);
    using V = NarrowPack<T>;
    for (double z = -12; z < 12; z += 0.0137) {
      const V v = broadcast<V>(static_cast<T>(z));
      const double x = double(v[0]);
      EXPECT_NEAR(gelu_lanes(v)[0],
                  activate(Activation::gelu, x),
                  tolerance * (1 + std::abs(x)));
      EXPECT_NEAR(
          gelu_slope_lanes(v)[0], derivative(Activation::gelu, x), tolerance);
    }
  };
  check(1.0F, 3e-7);
  check(1.0, 1e-15);
}

TEST(Fno, HasTheParametersOfThePaper) {
  const auto net = fno({.grid = {64, 64}}).make<float>(4096, 4096);
  Index complex = 0;
  for (const TensorInfo& t : net->tensors())
    if (t.kind == 'f') complex += t.size / 2;
  EXPECT_EQ(net->parameter_count(), 2368001);
  EXPECT_EQ(net->parameter_count() - complex, 1188353);
  EXPECT_THROW(fno({.grid = {64, 64}}).make<float>(4096, 4095), ContractError);
}

TEST(Fno, DrawsEveryTensorFromItsRange) {
  const auto net = fno(small()).make<double>(20, 20);
  Vector<double> p(net->parameter_count()), s;
  net->initialize(Rng::root("fno_test", 1), p, s);
  for (const TensorInfo& t : net->tensors()) {
    const auto part = p.segment(t.offset, t.size);
    const double bound =
        t.kind == 'f' ? 1.0 / 16 : 1 / std::sqrt(double(t.fan_in));
    EXPECT_LT(part.cwiseAbs().maxCoeff(), bound) << t.name;
    if (t.size > 4) {
      EXPECT_GT(part.maxCoeff(), 0.5 * bound) << t.name;
    }
    EXPECT_EQ(part.minCoeff() > 0, t.kind == 'f') << t.name;
  }
}

// ------------------------------------------------------ one block

struct Plane {
  const char* name;
  Grid from, to, period;
};

class Spectral : public testing::TestWithParam<Plane> {
 protected:
  static constexpr Index kChannels = 2, kModes = 3;
  Bench<double> make() const {
    const Plane& p = GetParam();
    const auto recipe = network(
        [&]<class U>() {
          return layers(spectral_block<U>({.from = p.from,
                                           .to = p.to,
                                           .period = p.period,
                                           .channels = kChannels,
                                           .modes = kModes,
                                           .before = Activation::gelu}));
        },
        Init::uniform);
    return Bench<double>(recipe, 0, 0);
  }
};

/// By the transforms' definitions.
Batch<double> plainly(const Plane& plane,
                      Index channels,
                      Index modes,
                      const Vector<double>& p,
                      const Batch<double>& x) {
  using C = std::complex<double>;
  const Index rows = plane.period.rows, columns = plane.period.columns;
  const auto wave = [](Index k, Index i, Index n) {
    return std::polar(1.0, 2 * std::numbers::pi * double(k * i) / double(n));
  };
  const Index size = channels * channels * modes * modes;
  Batch<double> y =
      Batch<double>::Zero(plane.to.positions() * channels, x.cols());
  for (Index s = 0; s < x.cols(); ++s) {
    const auto f = [&](Index c, Index r, Index q) {
      if (r >= plane.from.rows || q >= plane.from.columns) return 0.0;
      return activate(Activation::gelu,
                      x((r * plane.from.columns + q) * channels + c, s));
    };
    for (Index o = 0; o < channels; ++o) {
      Eigen::MatrixXcd a = Eigen::MatrixXcd::Zero(rows, modes);
      // The second block of weights is written last.
      for (const Index last : {0, 1})
        for (Index row = 0; row < modes; ++row)
          for (Index l = 0; l < modes; ++l) {
            const Index k = last == 1 ? rows - modes + row : row;
            C sum = 0;
            for (Index c = 0; c < channels; ++c) {
              C z = 0;
              for (Index r = 0; r < rows; ++r)
                for (Index q = 0; q < columns; ++q)
                  z += f(c, r, q) *
                       std::conj(wave(k, r, rows) * wave(l, q, columns));
              const Index at = 2 * last * size +
                               ((c * channels + o) * modes + row) * modes + l;
              sum += C(p(at), p(at + size)) * z;
            }
            a(k, l) = sum;
          }
      for (Index r = 0; r < plane.to.rows; ++r)
        for (Index q = 0; q < plane.to.columns; ++q) {
          double sum = 0;
          for (Index l = 0; l < modes; ++l) {
            C along = 0;
            for (Index k = 0; k < rows; ++k)
              along += a(k, l) * wave(k, r, rows);
            sum += (l == 0 ? 1 : 2) * std::real(along * wave(l, q, columns));
          }
          sum = sum / double(rows * columns) +
                p(4 * size + channels * channels + o);
          for (Index c = 0; c < channels; ++c)
            sum += p(4 * size + o * channels + c) * f(c, r, q);
          y((r * plane.to.columns + q) * channels + o, s) = sum;
        }
    }
  }
  return y;
}

TEST_P(Spectral, IsWhatTheTransformsSay) {
  auto b = make();
  const Batch<double> x = wavy<double>(b.net->inputs(), 3);
  EXPECT_TRUE(test::Comparator(1e-13, 0)(
      b.forward(x), plainly(GetParam(), kChannels, kModes, b.p, x)));
}

TEST_P(Spectral, GradientsAreThoseOfTheTransforms) {
  auto b = make();
  const Batch<double> x = wavy<double>(b.net->inputs(), 3);
  const Batch<double> y_bar = wavy<double>(b.net->outputs(), 3, 0.4);
  const auto value = [&](const Vector<double>& p, const Batch<double>& at) {
    return plainly(GetParam(), kChannels, kModes, p, at)
        .cwiseProduct(y_bar)
        .sum();
  };
  b.forward(x);
  const Vector<double> p_bar = b.parameters_bar(y_bar);
  // Linear in the parameters: the differences are exact.
  for (Index i = 0; i < b.p.size(); ++i) {
    Vector<double> up = b.p, down = b.p;
    up(i) += 1, down(i) -= 1;
    EXPECT_NEAR(p_bar(i), (value(up, x) - value(down, x)) / 2, 1e-11) << i;
  }
  const Batch<double> x_bar = b.in_bar(y_bar);
  const double h = 1e-3;
  for (Index i = 0; i < x.size(); i += 7) {
    const auto apart = [&](double step) {
      Batch<double> up = x, down = x;
      up(i) += step, down(i) -= step;
      return value(b.p, up) - value(b.p, down);
    };
    // Four points: an error of h^4, and of rounding over h.
    EXPECT_NEAR(x_bar(i), (8 * apart(h) - apart(2 * h)) / (12 * h), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Planes,
    Spectral,
    testing::Values(Plane{"grows", {5, 6}, {7, 9}, {7, 9}},
                    Plane{"shrinks", {8, 8}, {5, 7}, {8, 8}},
                    Plane{"all_rows", {6, 6}, {6, 6}, {6, 6}},
                    Plane{"odd_overlap", {6, 5}, {6, 5}, {6, 5}},
                    Plane{"even_overlap", {7, 4}, {7, 3}, {7, 4}},
                    Plane{"full_overlap", {7, 3}, {7, 3}, {7, 3}}),
    [](const testing::TestParamInfo<Plane>& at) { return at.param.name; });

// ------------------------------------------------------- the network

TEST(Fno, GradientsAgreeWithCentralDifferences) {
  Bench<double> b(fno(small()), 20, 20);
  Batch<double> in = wavy<double>(20, 5), out_bar = wavy<double>(20, 5, 0.2);
  b.forward(in);
  const Vector<double> p_bar = b.parameters_bar(out_bar);
  const Batch<double> in_bar = b.in_bar(out_bar);
  const auto expect_slope = [&](double& at, double bar) {
    const double h = 1e-5, old = at;
    at = old + h;
    const double up = b.forward(in).cwiseProduct(out_bar).sum();
    at = old - h;
    const double down = b.forward(in).cwiseProduct(out_bar).sum();
    at = old;
    EXPECT_NEAR(bar, (up - down) / (2 * h), 1e-8);
  };
  for (const TensorInfo& t : b.net->tensors())
    for (const Index i : {Index{0}, t.size / 2, t.size - 1})
      expect_slope(b.p(t.offset + i), p_bar(t.offset + i));
  for (Index i = 0; i < in.size(); i += 3) expect_slope(in(i), in_bar(i));
}

TEST(Fno, ASampleDependsOnItselfAlone) {
  Bench<float> b(fno(small()), 20, 20), one(fno(small()), 20, 20);
  const Batch<float> in = wavy<float>(20, 21), out_bar = wavy<float>(20, 21, 1);
  const Batch<float> out = b.forward(in), in_bar = b.in_bar(out_bar);
  for (const Index s : {0, 7, 20}) {
    expect_same_bits<Batch<float>>(one.forward(in.col(s)), out.col(s));
    expect_same_bits<Batch<float>>(one.in_bar(out_bar.col(s)), in_bar.col(s));
  }
}

TEST(Fno, ThreadsDoNotChangeBits) {
  Threads threads(3);
  Bench<float> b(fno(small()), 20, 20), many(fno(small()), 20, 20, &threads);
  for (const Index n : {3, 40}) {
    const Batch<float> in = wavy<float>(20, n), out_bar = wavy<float>(20, n, 1);
    expect_same_bits(b.forward(in), many.forward(in));
    expect_same_bits(b.parameters_bar(out_bar), many.parameters_bar(out_bar));
    expect_same_bits(b.in_bar(out_bar), many.in_bar(out_bar));
  }
}

TEST(Fno, FloatAgreesWithDouble) {
  Bench<double> b(fno(small()), 20, 20);
  Bench<float> f(fno(small()), 20, 20);
  f.p = b.p.cast<float>();
  const Batch<double> in = wavy<double>(20, 5);
  EXPECT_TRUE(test::Comparator(test::Tolerance<float>::relative, 0)(
      f.forward(in.cast<float>()), b.forward(in)));
}

}  // namespace
}  // namespace physinv::nn
