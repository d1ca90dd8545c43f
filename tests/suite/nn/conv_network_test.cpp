// Vgg and u-net as built: sizes, bits, reuse.

#include <gtest/gtest.h>

#include "suite/core/check.h"
#include "suite/core/threads.h"
#include "suite/nn/cnn.h"
#include "suite/nn/conv.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"
#include "tests/suite/nn/nn_testing.h"

namespace physinv::nn {
namespace {

struct Built {
  const char* name;
  NetworkRecipe recipe;
  Index inputs, outputs, parameters;
};

std::vector<Built> networks() {
  const auto packet = [](std::vector<Index> hidden) {
    return vgg({.channels = 1,
                .grid = {256},
                .features = {16, 16, 16, 16, 16},
                .hidden = std::move(hidden)});
  };
  return {
      {"packet", packet({64, 32}), 256, 1, 13921},
      {"packet_variant", packet({64, 32, 1}), 256, 1, 13925},
      {"ks",
       vgg({.channels = 2,
            .grid = {128},
            .features = {32, 32, 64, 64},
            .hidden = {64, 64}}),
       256,
       2,
       59650},
      {"packet_surrogate",
       unet({.grid = {256}, .scalars_before = 1}),
       257,
       256,
       13073},
      {"ks_surrogate",
       unet({.grid = {128}, .scalars_after = 2}),
       130,
       128,
       13121},
      // 3x3 taps: 160 + 8 x (9 f f + f + 2 f) with f = 16, but 2 f into
      // two of the eight; and 2 x 16 + 2 at the end.
      {"plane",
       unet({.grid = {16, 8},
             .channels = 2,
             .levels = 3,
             .features = 4,
             .outputs = 2}),
       256,
       256,
       9 * (2 * 4 + 7 * 16 + 2 * 32) + 10 * 12 + 10},
      // Its first columns are hidden.
      {"hidden_columns",
       unet({.grid = {16, 8},
             .scalars_after = 1,
             .levels = 3,
             .features = 4,
             .outputs = 2,
             .hidden = 6}),
       129,
       160,
       9 * (2 * 4 + 7 * 16 + 2 * 32) + 10 * 12 + 10},
      // Odd extents: 12 x 9, 6 x 4, 3 x 2.
      {"circular_plane",
       unet({.grid = {12, 9},
             .channels = 2,
             .levels = 3,
             .features = 4,
             .padding = Padding::circular,
             .init = Init::uniform}),
       216,
       108,
       9 * (2 * 4 + 7 * 16 + 2 * 32) + 10 * 12 + 5},
      {"plane_vgg",
       vgg({.channels = 2, .grid = {16, 8}, .features = {4, 5}, .hidden = {7}}),
       256,
       3,
       9 * (2 * 4 + 4 * 5) + 9 * 3 + (40 * 7 + 7 + 14) + (7 * 3 + 3)},
      {"dipole",
       cnn({.positions = 14,
            .channels = 2,
            .features = {20, 20, 20, 20, 20, 20}}),
       28,
       384,
       21984}};
}

class ConvNetwork : public testing::TestWithParam<Built> {
 protected:
  template <class T>
  Bench<T> make(Threads* threads = nullptr) {
    const Built& b = GetParam();
    return Bench<T>(b.recipe, b.inputs, b.outputs, threads);
  }
};

TEST_P(ConvNetwork, HasTheParametersOfThePaper) {
  const auto net =
      GetParam().recipe.make<float>(GetParam().inputs, GetParam().outputs);
  EXPECT_EQ(net->parameter_count(), GetParam().parameters);
  EXPECT_THROW(
      GetParam().recipe.make<float>(GetParam().inputs + 1, GetParam().outputs),
      ContractError);
}

TEST(BatchStatistics, AreThoseOfEveryPass) {
  const auto built = [](bool every) {
    return Bench<double>(unet({.grid = {12, 9},
                               .levels = 3,
                               .features = 4,
                               .padding = Padding::circular,
                               .batch_statistics = every}),
                         108,
                         108);
  };
  auto every = built(true), training = built(false);
  EXPECT_EQ(every.net->state_count(), 0);
  const Batch<double> in = wavy<double>(108, 5),
                      out_bar = wavy<double>(108, 5, 0.3);
  expect_same_bits(every.forward(in), training.forward(in, {.training = true}));
  expect_same_bits(every.parameters_bar(out_bar),
                   training.parameters_bar(out_bar));
  expect_same_bits(every.in_bar(out_bar), training.in_bar(out_bar));
}

// As the whole plane with zeros for what is hidden, in and out.
TEST(Unet, HidesColumns) {
  constexpr Index kColumns = 8, kHidden = 3, kRows = 4, kCount = 5;
  const auto built = [](Index hidden) {
    return Bench<double>(unet({.grid = {kColumns, kRows},
                               .levels = 2,
                               .features = 4,
                               .outputs = 2,
                               .hidden = hidden}),
                         kColumns * kRows,
                         2 * (kColumns - hidden) * kRows);
  };
  auto hiding = built(kHidden), whole = built(0);
  const Batch<double> in = wavy<double>(kColumns * kRows, kCount);
  Batch<double> zeroed = in;
  for (Index p = 0; p < in.rows(); ++p)
    if (p % kColumns < kHidden) zeroed.row(p).setZero();
  const auto left = [](const Batch<double>& all) {
    std::vector<Index> rows;
    for (Index p = 0; p < all.rows(); ++p)
      if (p % kColumns >= kHidden) rows.push_back(p);
    return Batch<double>(all(rows, Eigen::all));
  };
  expect_same_bits(hiding.forward(in), left(whole.forward(zeroed)));
  Batch<double> bar = wavy<double>(2 * kColumns * kRows, kCount, 0.3);
  for (Index p = 0; p < bar.rows(); ++p)
    if (p % kColumns < kHidden) bar.row(p).setZero();
  expect_same_bits(hiding.parameters_bar(left(bar)), whole.parameters_bar(bar));
  Batch<double> in_bar = whole.in_bar(bar);
  for (Index p = 0; p < in_bar.rows(); ++p)
    if (p % kColumns < kHidden) in_bar.row(p).setZero();
  expect_same_bits(hiding.in_bar(left(bar)), in_bar);
}

TEST(Unet, HasTheParametersOfThePaperOnAPlane) {
  const auto net = unet({.grid = {64, 64}}).make<float>(64 * 64, 64 * 64);
  EXPECT_EQ(net->parameter_count(), 37697);
}

template <class T>
void expect_equal_passes(Bench<T>& a, Bench<T>& b, Index n, bool training) {
  const Batch<T> in = wavy<T>(a.net->inputs(), n);
  const Batch<T> out_bar = wavy<T>(a.net->outputs(), n, 0.3);
  expect_same_bits(a.forward(in, {.training = training}),
                   b.forward(in, {.training = training}));
  expect_same_bits(a.parameters_bar(out_bar), b.parameters_bar(out_bar));
  expect_same_bits(a.in_bar(out_bar), b.in_bar(out_bar));
}

TEST_P(ConvNetwork, ThreadsDoNotChangeBits) {
  Threads threads(3);
  for (const bool training : {false, true}) {
    auto one = make<float>(), three = make<float>(&threads);
    expect_equal_passes(one, three, 40, training);
    auto one64 = make<double>(), three64 = make<double>(&threads);
    expect_equal_passes(one64, three64, 21, training);
  }
}

TEST_P(ConvNetwork, TapesAndWorkspacesAreReused) {
  auto used = make<float>();
  for (const Index n : {50, 3}) {
    const Batch<float> in = wavy<float>(used.net->inputs(), n, 9.0);
    used.forward(in, {.training = true});
    used.in_bar(wavy<float>(used.net->outputs(), n));
    used.parameters_bar(wavy<float>(used.net->outputs(), n));
  }
  const std::size_t bytes = used.tape.bytes() + used.work.bytes();
  for (const Index n : {50, 17, 2}) {
    auto fresh = make<float>();
    expect_equal_passes(used, fresh, n, true);
  }
  EXPECT_EQ(used.tape.bytes() + used.work.bytes(), bytes);
}

TEST_P(ConvNetwork, SameInputKeepsBits) {
  auto b = make<float>();
  const Index n = 6;
  const Batch<float> in = wavy<float>(b.net->inputs(), n);
  const Batch<float> out_bar = wavy<float>(b.net->outputs(), n, 0.3);
  const Batch<float> first =
      b.forward(in, {.training = true, .fixed_input = true});
  const Vector<float> bar = b.parameters_bar(out_bar);
  expect_same_bits(
      b.forward(in,
                {.training = true, .same_input = true, .fixed_input = true}),
      first);
  expect_same_bits(b.parameters_bar(out_bar), bar);
  // The rearrangement in front is not run again; nothing is folded.
  const std::string name = GetParam().name;
  const bool has_prefix = (!name.starts_with("packet") && name != "dipole") ||
                          GetParam().inputs == 257;
  EXPECT_EQ(b.work.counts[Counter::skipped_features],
            has_prefix ? std::uint64_t(n) : 0U);
  EXPECT_EQ(b.work.counts[Counter::skipped_rows], 0U);
}

TEST_P(ConvNetwork, EvaluatedSamplesAreIndependentBitwise) {
  auto b = make<float>();
  const Batch<float> in = wavy<float>(b.net->inputs(), 27);
  const Batch<float> out_bar = wavy<float>(b.net->outputs(), 27, 0.3);
  b.forward(in, {.training = true});
  b.net->update_state(b.tape, b.s);
  const Batch<float> out = b.forward(in), in_bar = b.in_bar(out_bar);
  for (const auto& some :
       {std::vector<Index>{26}, std::vector<Index>{4, 1, 0, 13, 25}}) {
    expect_same_bits(b.forward(Batch<float>(in(Eigen::all, some))),
                     Batch<float>(out(Eigen::all, some)));
    expect_same_bits(b.in_bar(Batch<float>(out_bar(Eigen::all, some))),
                     Batch<float>(in_bar(Eigen::all, some)));
  }
}

TEST_P(ConvNetwork, NaNEndsItsSampleAlone) {
  auto b = make<float>();
  Batch<float> in = wavy<float>(b.net->inputs(), 5);
  const Batch<float> out = b.forward(in);
  in(in.rows() - 1, 2) = std::nanf("");
  const Batch<float> hit = b.forward(in);
  EXPECT_FALSE(hit.col(2).allFinite());
  for (const Index j : {0, 1, 3, 4})
    expect_same_bits(Batch<float>(hit.col(j)), Batch<float>(out.col(j)));
}

INSTANTIATE_TEST_SUITE_P(All,
                         ConvNetwork,
                         testing::ValuesIn(networks()),
                         [](const testing::TestParamInfo<Built>& at) {
                           return std::string(at.param.name);
                         });

/// J (rows x parameters) from what a network says of its layers.
Batch<double> assembled(const std::vector<LayerRows<double>>& layers,
                        Index per,
                        Index rows,
                        Index parameters) {
  Batch<double> j = Batch<double>::Constant(rows, parameters, std::nan(""));
  for (const auto& l : layers) {
    const Index weights = l.inputs * l.outputs, channels = l.inputs / l.taps;
    j.middleCols(l.offset, weights + l.outputs).setZero();
    for (Index r = 0; r < rows; ++r)
      for (Index p = 0; p < l.positions; ++p)
        for (Index o = 0; o < l.outputs; ++o) {
          const double b = l.b[(p * l.b_step + o) * l.b_stride + r];
          j(r, l.offset + weights + o) += b;
          for (Index t = 0; t < l.taps; ++t)
            for (Index c = 0; c < channels; ++c)
              j(r, l.offset + (o * channels + c) * l.taps + t) +=
                  b *
                  l.a[(p * l.a_step + t * channels + c) * l.a_stride + r / per];
        }
  }
  return j;
}

TEST(Cnn, RowsAreBackwardPasses) {
  for (const Index taps : {1, 3, 5}) {
    const Index n = 3, per = 4;
    Bench<double> b(
        cnn({.positions = 9, .channels = 2, .features = {4, 3}, .taps = taps}),
        18,
        6);
    b.forward(wavy<double>(18, n));
    const Batch<double> out_bar = wavy<double>(6, n * per, 0.7);
    const Workspace::Scope scope(b.work);
    std::vector<LayerRows<double>> layers;
    by_rows(*b.net).jacobian_rows(b.p, b.tape, out_bar, layers, b.work);
    ASSERT_EQ(layers.size(), 3U);
    const Batch<double> j = assembled(layers, per, n * per, b.p.size());
    for (Index r = 0; r < j.rows(); ++r) {
      Batch<double> one = Batch<double>::Zero(6, n);
      one.col(r / per) = out_bar.col(r);
      const Vector<double> bar = b.parameters_bar(one);
      EXPECT_LE((j.row(r).transpose() - bar).cwiseAbs().maxCoeff(),
                1e-14 * bar.cwiseAbs().maxCoeff())
          << taps << " taps, row " << r;
    }
  }
}

TEST(Cnn, PaddedConvolutionsGiveNoRows) {
  const auto padded = conv<double>({.grid = {5}, .in = 2, .out = 3});
  std::vector<LayerRows<double>> layers;
  EXPECT_THROW(padded->add_rows({}, {}, 0, layers), ContractError);
  EXPECT_THROW(conv<double>({.grid = {2}, .padding = Padding::none}),
               ContractError);
  EXPECT_THROW(
      conv<double>({.grid = {5, 5}, .taps = {3, 3}, .padding = Padding::none}),
      ContractError);
}

}  // namespace
}  // namespace physinv::nn
