#include "suite/nn/fno.h"

#include <functional>
#include <memory>
#include <numeric>
#include <utility>

#include "suite/core/check.h"
#include "suite/nn/activation.h"
#include "suite/nn/conv.h"
#include "suite/nn/per_piece.h"
#include "suite/nn/rearrange.h"
#include "suite/nn/sequential.h"
#include "suite/nn/spectral.h"

namespace physinv::nn {
namespace {

/// Positions that go through the wide end together: enough for a kernel, few
/// enough for a cache.
constexpr Index kPiece = 8;

template <class T>
LayerPointer<T> pointwise(Grid grid, Index in, Index out) {
  return conv<T>({.grid = grid, .in = in, .out = out, .taps = {1, 1}});
}

/// width -> hidden, GELU, -> 1.
template <class T>
LayerPointer<T> head(const FnoOptions& o) {
  const Index piece = std::gcd(o.grid.positions(), kPiece);
  const Grid some{piece};
  Layers<T> inner;
  inner.push_back(pointwise<T>(some, o.width, o.hidden));
  inner.push_back(activation_layer<T>(Activation::gelu, piece * o.hidden));
  inner.push_back(pointwise<T>(some, o.hidden, 1));
  return per_piece<T>(o.grid.positions() / piece, std::move(inner));
}

template <class T>
std::unique_ptr<Network<T>> make(const FnoOptions& o,
                                 Index inputs,
                                 Index outputs) {
  SUITE_CHECK(o.grid.columns > 0 && o.grid.rows > 0,
              "a grid must have at least one position");
  SUITE_CHECK(inputs == o.grid.positions() && outputs == o.grid.positions(),
              "the network's grid does not match its input and output");
  SUITE_CHECK(o.blocks >= 1, "an operator must have at least one block");
  SUITE_CHECK(o.modes >= 1, "an operator must have at least one mode");
  SUITE_CHECK(o.width >= 1 && o.hidden >= 1,
              "width and hidden must be at least 1");
  SUITE_CHECK(o.padding >= 0, "padding must not be negative");
  const Grid period{o.grid.columns + o.padding, o.grid.rows + o.padding};
  Layers<T> layers;
  layers.push_back(coordinates<T>(o.grid));
  layers.push_back(pointwise<T>(o.grid, 3, o.width));
  for (Index block = 0; block < o.blocks; ++block)
    layers.push_back(spectral_block<T>(
        {.from = block == 0 ? o.grid : period,
         .to = block == o.blocks - 1 ? o.grid : period,
         .period = period,
         .channels = o.width,
         .modes = o.modes,
         .before = block == 0 ? Activation::identity : Activation::gelu}));
  layers.push_back(head<T>(o));
  return sequential<T>(std::move(layers), Init::uniform);
}

}  // namespace

NetworkRecipe fno(const FnoOptions& options) {
  return {.description = "fno " + in_line(describe(options)),
          .make_float = std::bind_front(make<float>, options),
          .make_double = std::bind_front(make<double>, options)};
}

}  // namespace physinv::nn
