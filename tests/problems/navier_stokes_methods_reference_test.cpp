// The entries of jpo-navier-stokes that are networks and parts of methods.

#include <gtest/gtest.h>

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
Batch<T> wave_input(Index channels, Index rows, Index columns, Index n) {
  return Batch<T>::NullaryExpr(
      channels * rows * columns, n, [=](Index row, Index e1) {
        const double c = double(row / (rows * columns)),
                     i = double(row / columns % rows),
                     j = double(row % columns), e = double(e1);
        return static_cast<T>(
            std::sin(0.13 * (e + 1) * i + 0.29 * (c + 1) * j + 0.7 * e * c) +
            0.3 * std::cos(0.31 * i * (c + 1) - 0.17 * (e + 1) * j));
      });
}

template <class T>
void expect_gradients(const nn::Bench<T>& b,
                      const Vector<T>& bar,
                      const Json& out) {
  const auto& tensors = b.net->tensors();
  ASSERT_EQ(tensors.size(), out.at("tensor_shapes").size());
  const Vector<double> norms = vector(out.at("grad_l2_per_tensor"));
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
        sizeof(T) == 8 ? 1e-9 + 1e-8 * expected
                       : kSingle * std::max(expected, 1e-2 * norms.maxCoeff());
    EXPECT_NEAR(part.norm(), expected, allowed);
    const Vector<double> first = vector(out.at("grad_first3_per_tensor")[t]);
    for (Index k = 0; k < first.size(); ++k)
      EXPECT_NEAR(part(k), first(k), allowed);
  }
}

template <class T>
void check_g2s(const Json& entry) {
  const Json &in = entry.at("inputs"), &out = entry.at("outputs");
  ASSERT_EQ(in.at("q"), 0.0);
  ASSERT_EQ(in.at("cotangent"), "sin(1+e+2k+q)");
  const FileTolerance<T> near(entry, kSingle);
  const auto n = in.at("n").get<Index>();
  nn::Bench<T> b(nn::vgg({.channels = 2,
                          .grid = {.columns = 32, .rows = 64},
                          .features = {16, 32, 32, 32},
                          .hidden = {64, 64}}),
                 2 * 64 * 32,
                 3);
  ASSERT_EQ(b.p.size(), out.at("parameter_count").get<Index>());
  use_sines(b);
  const Batch<T> y = b.forward(wave_input<T>(2, 64, 32, n), {.training = true});
  near(y.template cast<double>(), columns(out.at("output")), "output");
  const Batch<T> bar = Batch<T>::NullaryExpr(3, n, [](Index k, Index e) {
    return static_cast<T>(std::sin(1 + double(e) + 2 * double(k)));
  });
  expect_gradients(b, b.parameters_bar(bar), out);
}

template <class T>
void check_g2g(const Json& entry) {
  const Json &in = entry.at("inputs"), &out = entry.at("outputs");
  ASSERT_EQ(in.at("q"), 0.0);
  ASSERT_EQ(in.at("cotangent"), "sin(0.05 i (k+1)+0.07 j+e+q)");
  const FileTolerance<T> near(entry, kSingle);
  const auto n = in.at("n").get<Index>();
  nn::Bench<T> b(
      nn::unet(
          {.grid = {.columns = 64, .rows = 64}, .channels = 5, .outputs = 2}),
      5 * 4096,
      2 * 4096);
  ASSERT_EQ(b.p.size(), out.at("parameter_count").get<Index>());
  use_sines(b);
  const Batch<double> y =
      b.forward(wave_input<T>(5, 64, 64, n), {.training = true})
          .template cast<double>();
  const Json& expected = out.at("output");
  near(Vector<double>::Constant(1, y.norm()),
       Vector<double>::Constant(1, number(expected.at("l2"))),
       "l2");
  for (Index e = 0; e < n; ++e)
    for (Index c = 0; c < 2; ++c) {
      const Json& probes = in.at("probes");
      Vector<double> got(Index(probes.size()));
      for (Index k = 0; k < got.size(); ++k) {
        const Json& at = probes[std::size_t(k)];
        got(k) = y((c * 64 + at[0].get<Index>()) * 64 + at[1].get<Index>(), e);
      }
      near(got,
           vector(expected.at("probes")[std::size_t(e)][std::size_t(c)]),
           "probes");
    }
  const Batch<T> bar =
      Batch<T>::NullaryExpr(2 * 4096, n, [](Index row, Index e) {
        const double k = double(row / 4096), i = double(row / 64 % 64),
                     j = double(row % 64);
        return static_cast<T>(
            std::sin(0.05 * i * (k + 1) + 0.07 * j + double(e)));
      });
  expect_gradients(b, b.parameters_bar(bar), out);
}

void check_clipping(const Json& entry) {
  const Json &in = entry.at("inputs"), &out = entry.at("outputs");
  const FileTolerance<double> near(entry);
  Batch<double> g = columns(in.at("gradients"));
  near(g.colwise().norm().transpose(), vector(out.at("norms")), "norms");
  const double tau =
      ClipPercentile(number(in.at("percentile")) / 100).operator()<double>(g);
  near(Vector<double>::Constant(1, tau),
       Vector<double>::Constant(1, number(out.at("threshold"))),
       "threshold");
  near(g, columns(out.at("clipped")), "clipped");
}

void check_wall(const Json& entry) {
  const Json &in = entry.at("inputs"), &out = entry.at("outputs");
  const FileTolerance<double> near(entry);
  const Batch<double> s = columns(in.at("s"));
  const BoundaryLoss wall(
      vector(in.at("lo")), vector(in.at("hi")), number(in.at("gamma")));
  Vector<double> loss = Vector<double>::Zero(s.cols());
  Batch<double> g = Batch<double>::Zero(s.rows(), s.cols());
  wall.add(s, number(in.at("weight")), loss, g);
  near(loss, vector(out.at("value")), "value");
  near(g, columns(out.at("grad")), "grad");
}

TEST(NavierStokesReference, NetworksAndMethods) {
  const std::map<std::string, EntryCheck> checks = {
      {"g2s", [](const Json& e) { check_g2s<float>(e), check_g2s<double>(e); }},
      {"g2g", [](const Json& e) { check_g2g<float>(e), check_g2g<double>(e); }},
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
