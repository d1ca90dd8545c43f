// Options that no network can have are refused, with a line that says why.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "suite/core/check.h"
#include "suite/nn/cnn.h"
#include "suite/nn/fno.h"
#include "suite/nn/mlp.h"
#include "suite/nn/pooled_cnn.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"

namespace physinv::nn {
namespace {

/// What is said of a network in either precision; nothing if it is made.
template <class T>
std::string said(const NetworkRecipe& recipe, Index inputs, Index outputs) {
  try {
    recipe.make<T>(inputs, outputs);
  } catch (const ContractError& e) {
    return e.what();
  }
  return {};
}

/// `options` makes a network; after any of `spoilt` it does not.
template <class Options>
void expect_refused(const std::function<NetworkRecipe(const Options&)>& make,
                    const Options& options,
                    Index inputs,
                    Index outputs,
                    const std::vector<std::function<void(Options&)>>& spoilt) {
  EXPECT_EQ(said<double>(make(options), inputs, outputs), "");
  EXPECT_EQ(said<float>(make(options), inputs, outputs), "");
  for (std::size_t i = 0; i < spoilt.size(); ++i) {
    SCOPED_TRACE(i);
    Options bad = options;
    spoilt[i](bad);
    for (const std::string& line : {said<double>(make(bad), inputs, outputs),
                                    said<float>(make(bad), inputs, outputs)}) {
      EXPECT_NE(line, "");
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
  }
}

TEST(NetworkOptions, Mlp) {
  using O = MlpOptions;
  expect_refused<O>(mlp,
                    {.hidden = {5, 4}},
                    3,
                    2,
                    {[](O& o) { o.hidden[0] = 0; },
                     [](O& o) { o.hidden[1] = -4; },
                     [](O& o) { o.frequencies = -1; }});
}

TEST(NetworkOptions, Cnn) {
  using O = CnnOptions;
  expect_refused<O>(cnn,
                    {.positions = 8, .channels = 2, .features = {3, 3}},
                    16,
                    5,
                    {[](O& o) { o.positions = 0; },
                     [](O& o) { o.positions = -8, o.channels = -2; },
                     [](O& o) { o.features[1] = 0; },
                     [](O& o) { o.taps = 0; },
                     [](O& o) { o.taps = -3; },
                     [](O& o) { o.taps = 9; }});
}

TEST(NetworkOptions, PooledCnn) {
  using O = PooledCnnOptions;
  expect_refused<O>(pooled_cnn,
                    {.positions = 16, .features = {4, 4}, .hidden = {6}},
                    16,
                    1,
                    {[](O& o) { o.positions = -16; },
                     [](O& o) { o.features[0] = 0; },
                     [](O& o) { o.features[1] = -1; },
                     [](O& o) { o.hidden[0] = 0; }});
}

TEST(NetworkOptions, Unet) {
  using O = UnetOptions;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  expect_refused<O>(unet,
                    {.grid = {8, 8}, .scalars_after = 1, .levels = 2},
                    65,
                    64,
                    {[](O& o) {
                       o.grid = {-8, -8};
                     },
                     [](O& o) { o.channels = 0; },
                     [](O& o) { o.features = 0; },
                     [](O& o) { o.features = -16; },
                     [](O& o) { o.outputs = 0; },
                     [](O& o) { o.levels = 0; },
                     [](O& o) { o.scalars_before = -1, o.scalars_after = 2; },
                     [](O& o) { o.hidden = -1; },
                     [](O& o) { o.scalar_unit = 0; },
                     [](O& o) { o.scalar_unit = kNan; },
                     [](O& o) { o.scalar_shift = kNan; }});
  // What double can hold and float cannot.
  O tiny{
      .grid = {8, 8}, .scalars_after = 1, .scalar_unit = 1e-100, .levels = 2};
  EXPECT_EQ(said<double>(unet(tiny), 65, 64), "");
  EXPECT_NE(said<float>(unet(tiny), 65, 64).find("scalar_unit = 1e-100"),
            std::string::npos);
}

TEST(NetworkOptions, Vgg) {
  using O = VggOptions;
  expect_refused<O>(vgg,
                    {.grid = {8, 8}, .features = {4, 4}, .hidden = {6}},
                    64,
                    3,
                    {[](O& o) {
                       o.channels = -1, o.grid = {-8, 8};
                     },
                     [](O& o) { o.features[1] = 0; },
                     [](O& o) { o.hidden[0] = -6; }});
}

TEST(NetworkOptions, Fno) {
  using O = FnoOptions;
  expect_refused<O>(fno,
                    {.grid = {5, 4},
                     .padding = 2,
                     .modes = 3,
                     .width = 4,
                     .blocks = 3,
                     .hidden = 6},
                    20,
                    20,
                    {[](O& o) {
                       o.grid = {-5, -4};
                     },
                     [](O& o) { o.padding = -1; },
                     [](O& o) { o.modes = 0; },
                     [](O& o) { o.modes = -3; },
                     [](O& o) { o.modes = 4; },
                     [](O& o) { o.width = 0; },
                     [](O& o) { o.blocks = 0; },
                     [](O& o) { o.hidden = 0; }});
  EXPECT_NE(
      said<double>(fno({.grid = {5, 4}, .padding = 2, .modes = 0}), 20, 20)
          .find("must have at least one mode"),
      std::string::npos);
}

}  // namespace
}  // namespace physinv::nn
