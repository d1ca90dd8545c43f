/// U-net (G2G): from fields on a grid to fields on the same grid.
///
/// D(a->b) = conv(a->b) - BN - ReLU - conv(b->b) - BN - ReLU, 3 taps per axis.
/// in: D(c->f); levels - 1 times [max pooling 2, D(f->f)]; as often [linear
/// upsampling 2, concatenate (skip, upsampled), D(2f->f)]; a 1-tap convolution
/// f->outputs. (Joint parameter optimization, App. C.)
///
/// Rows of the input: `scalars_before` numbers, `channels` fields as
/// [channel][position], `scalars_after` numbers. A scalar z becomes a field of
/// constant value (z - scalar_shift) / scalar_unit.
///
/// On a plane of 64 x 64 with one channel: 37,697 parameters. (Scale-invariant
/// physics training, App. B.2.)
#pragma once

#include "suite/core/network.h"
#include "suite/nn/grid.h"
#include "suite/nn/kinds.h"

namespace physinv::nn {

struct UnetOptions {
  Grid grid;  ///< extent at least 2^(levels - 1), on a plane 2^levels; pooling
              ///< rounds down, upsampling returns to the finer level's extent
  Index channels = 1;
  Index scalars_before = 0, scalars_after = 0;
  double scalar_shift = 0, scalar_unit = 1;
  Index levels = 4, features = 16;
  Index outputs = 1;  ///< fields
  Index hidden = 0;   ///< columns of all fields, the first ones, that are read
                      ///< as zero and have no output; two outputs or more
  Padding padding = Padding::zero;
  bool batch_statistics = false;  ///< in every pass, see ConvOptions
  Init init = Init::fan_in;

  auto fields() const {
    return std::tuple{
        word("grid", grid.text(), grid),
        word("scalars",
             text_of(std::array{scalars_before, scalars_after}, "+"),
             scalars_before,
             scalars_after),
        field("shift", scalar_shift),
        field("unit", scalar_unit),
        field("channels", channels),
        field("levels", levels),
        field("features", features),
        field("outputs", outputs),
        if_changed(field("hidden", hidden)),
        if_changed(word("", to_string(padding), padding)),
        if_changed(word(
            "", batch_statistics ? "batch_statistics" : "", batch_statistics)),
        if_changed(field("init", init))};
  }
};

NetworkRecipe unet(const UnetOptions& options);

}  // namespace physinv::nn
