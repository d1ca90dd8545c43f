// The entries of jpo-navier-stokes that are networks and parts of methods.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "baselines/boundary_loss.h"
#include "optimizers/steps/clip_percentile.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"
#include "tests/suite/nn/nn_testing.h"
#include "tests/support/mac_cormack_reference.h"

namespace physinv::test {
namespace {

constexpr double kSingle = 1e-3;  // batch normalisation over few values

/// Weights of the file, whose tensors are in the order of the memory.
template <class T>
void use_sines(nn::Bench<T>& b) {
  Index l = 0;
  for (const TensorInfo& t : b.net->tensors()) {
    const bool matrix = t.kind == 'm' || t.kind == 'k';
    const double scale = matrix ? std::sqrt(2 / double(t.fan_in)) : 0.1;
    for (Index k = 0; k < t.size; ++k)
      b.p(t.offset + k) =
          static_cast<T>((t.kind == 's' ? 1 : 0) +
                         scale * std::sin(0.37 * double(k) + 1.1 * double(l)));
    ++l;
  }
}

/// x[e][c][i][j] of the file, rows [c][i][j].
template <class T>
Batch<T> wave_input(
    Index channels, Index rows, Index columns, Index n, double q) {
  return Batch<T>::NullaryExpr(
      channels * rows * columns, n, [=](Index row, Index e1) {
        const double c = double(row / (rows * columns)),
                     i = double(row / columns % rows),
                     j = double(row % columns), e = double(e1);
        return static_cast<T>(
            std::sin(0.13 * (e + 1) * i + 0.29 * (c + 1) * j + 0.7 * e * c +
                     q) +
            0.3 * std::cos(0.31 * i * (c + 1) - 0.17 * (e + 1) * j + q));
      });
}

template <class T>
void expect_gradients(const nn::Bench<T>& b,
                      const Vector<T>& bar,
                      const Json& out,
                      const FileTolerance<double>& file) {
  const auto& tensors = b.net->tensors();
  ASSERT_EQ(tensors.size(), out.at("tensor_shapes").size());
  const Vector<double> norms = vector(out.at("grad_l2_per_tensor"));
  ASSERT_EQ(norms.size(), Index(tensors.size()));
  for (std::size_t t = 0; t < tensors.size(); ++t) {
    SCOPED_TRACE(tensors[t].name);
    Index size = 1;
    for (const Json& extent : out.at("tensor_shapes")[t])
      size *= extent.get<Index>();
    ASSERT_EQ(tensors[t].size, size);
    const Vector<double> part =
        bar.segment(tensors[t].offset, size).template cast<double>();
    const double expected = norms(Index(t));
    const double allowed =
        sizeof(T) == 8 ? file.abs + file.rel * expected
                       : kSingle * std::max(expected, 1e-2 * norms.maxCoeff());
    EXPECT_NEAR(part.norm(), expected, allowed);
    const Vector<double> first = vector(out.at("grad_first3_per_tensor")[t]);
    ASSERT_LE(first.size(), size);
    for (Index k = 0; k < first.size(); ++k)
      EXPECT_NEAR(part(k), first(k), allowed);
  }
}

template <class T>
void check_g2s(const Json& entry) {
  const Json in = entry.at("inputs"), out = entry.at("outputs");
  expect_formula(in,
                 "input",
                 "x[e][c][i][j]=sin(0.13(e+1)i+0.29(c+1)j+0.7ec+q)+"
                 "0.3cos(0.31 i (c+1)-0.17(e+1)j+q)");
  expect_formula(in, "cotangent", "sin(1+e+2k+q)");
  const double q = in.at("q");
  const FileTolerance<T> near(entry, kSingle);
  const Index n = in.at("n");
  ASSERT_GE(n, 1);
  nn::Bench<T> b(nn::vgg({.channels = 2,
                          .grid = {.columns = 32, .rows = 64},
                          .features = {16, 32, 32, 32},
                          .hidden = {64, 64}}),
                 2 * 64 * 32,
                 3);
  ASSERT_EQ(b.p.size(), out.at("parameter_count").get<Index>());
  use_sines(b);
  const Batch<T> y =
      b.forward(wave_input<T>(2, 64, 32, n, q), {.training = true});
  near(y.template cast<double>(), columns(out.at("output")), "output");
  const Batch<T> bar = Batch<T>::NullaryExpr(3, n, [q](Index k, Index e) {
    return static_cast<T>(std::sin(1 + double(e) + 2 * double(k) + q));
  });
  expect_gradients(b, b.parameters_bar(bar), out, FileTolerance<double>(entry));
}

template <class T>
void check_g2g(const Json& entry) {
  const Json in = entry.at("inputs"), out = entry.at("outputs");
  expect_formula(in, "input", "same formula as g2s on 64x64 with 5 channels");
  expect_formula(in, "cotangent", "sin(0.05 i (k+1)+0.07 j+e+q)");
  const double q = in.at("q");
  const FileTolerance<T> near(entry, kSingle);
  const Index n = in.at("n");
  ASSERT_GE(n, 1);
  nn::Bench<T> b(
      nn::unet(
          {.grid = {.columns = 64, .rows = 64}, .channels = 5, .outputs = 2}),
      5 * 4096,
      2 * 4096);
  ASSERT_EQ(b.p.size(), out.at("parameter_count").get<Index>());
  use_sines(b);
  const Batch<double> y =
      b.forward(wave_input<T>(5, 64, 64, n, q), {.training = true})
          .template cast<double>();
  const Json expected = out.at("output");
  near(y.norm(), expected.at("l2"), "l2");
  const std::vector<std::array<Index, 2>> probes = in.at("probes");
  for (Index e = 0; e < n; ++e)
    for (Index c = 0; c < 2; ++c) {
      Vector<double> got(Index(probes.size()));
      for (std::size_t k = 0; k < probes.size(); ++k) {
        const auto [i, j] = probes[k];
        ASSERT_TRUE(0 <= i && i < 64 && 0 <= j && j < 64);
        got(Index(k)) = y((c * 64 + i) * 64 + j, e);
      }
      near(got, vector(expected.at("probes")[e][c]), "probes");
    }
  const Batch<T> bar =
      Batch<T>::NullaryExpr(2 * 4096, n, [q](Index row, Index e) {
        const double k = double(row / 4096), i = double(row / 64 % 64),
                     j = double(row % 64);
        return static_cast<T>(
            std::sin(0.05 * i * (k + 1) + 0.07 * j + double(e) + q));
      });
  expect_gradients(b, b.parameters_bar(bar), out, FileTolerance<double>(entry));
}

void check_clipping(const Json& entry) {
  const Json in = entry.at("inputs"), out = entry.at("outputs");
  const FileTolerance<double> near(entry);
  Batch<double> g = columns(in.at("gradients"));
  ASSERT_GE(g.cols(), 1);
  near(g.colwise().stableNorm().transpose(), vector(out.at("norms")), "norms");
  const double tau =
      ClipPercentile(number(in.at("percentile")) / 100).operator()<double>(g);
  near(tau, out.at("threshold"), "threshold");
  near(g, columns(out.at("clipped")), "clipped");
}

void check_wall(const Json& entry) {
  const Json in = entry.at("inputs"), out = entry.at("outputs");
  const FileTolerance<double> near(entry);
  const Batch<double> s = columns(in.at("s"));
  const BoundaryLoss wall(vector(in.at("lo"), s.rows()),
                          vector(in.at("hi"), s.rows()),
                          number(in.at("gamma")));
  Vector<double> loss = Vector<double>::Zero(s.cols());
  Batch<double> g = Batch<double>::Zero(s.rows(), s.cols());
  wall.add(s, number(in.at("weight")), loss, g);
  near(loss, vector(out.at("value")), "value");
  near(g, columns(out.at("grad")), "grad");
}

TEST(NavierStokesReference, NetworksAndMethods) {
  const std::map<std::string, EntryCheck> checks = {
      {"g2s", in_both(check_g2s<float>, check_g2s<double>)},
      {"g2g", in_both(check_g2g<float>, check_g2g<double>)},
      {"percentile_clip", check_clipping},
      {"boundary_loss", check_wall}};
  const std::set<std::string> elsewhere = {"lookup",
                                           "mac_cormack",
                                           "projection",
                                           "steps",
                                           "noise",
                                           "masks",
                                           "blast",
                                           "scene",
                                           "scores"};
  check_entries("jpo-navier-stokes", checks, elsewhere);
}

}  // namespace
}  // namespace physinv::test
