/// Multilayer perceptrons.
///
///   nn::mlp({.hidden = {128, 128, 128}, .frequencies = 4})
///
/// is encoding - [Linear - activation (- BatchNorm)] per hidden layer -
/// Linear; with 4 inputs and 2 outputs it has 37,506 parameters.
#pragma once

#include <vector>

#include "suite/core/network.h"
#include "suite/core/options.h"
#include "suite/nn/kinds.h"

namespace physinv::nn {

struct MlpOptions {
  std::vector<Index> hidden;  ///< features of each hidden layer
  Index frequencies = 0;      ///< of the positional encoding; 0 = none
  Activation activation = Activation::relu;
  Activation output = Activation::identity;
  bool batch_norm = false;  ///< behind each hidden activation
  Init init = Init::fan_in;

  auto fields() const {
    return std::tuple{word("hidden", text_of(hidden, "-"), hidden),
                      field("frequencies", frequencies),
                      field("activation", activation),
                      field("output", output),
                      field("batch_norm", batch_norm),
                      if_changed(field("init", init))};
  }
};

NetworkRecipe mlp(const MlpOptions& options);

}  // namespace physinv::nn
