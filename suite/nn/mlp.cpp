#include "suite/nn/mlp.h"

#include <functional>
#include <memory>
#include <utility>

#include "suite/core/check.h"
#include "suite/core/option_check.h"
#include "suite/nn/activation.h"
#include "suite/nn/batch_norm.h"
#include "suite/nn/encoding.h"
#include "suite/nn/linear.h"
#include "suite/nn/sequential.h"

namespace physinv::nn {
namespace {

template <class T>
std::unique_ptr<Network<T>> make(const MlpOptions& o,
                                 Index inputs,
                                 Index outputs) {
  SUITE_CHECK(all_positive(o.hidden),
              "a hidden layer must have at least 1 feature");
  SUITE_CHECK(o.frequencies >= 0, "frequencies must not be negative");
  Layers<T> layers;
  Index size = inputs;
  const auto add = [&](auto layer) {
    size = layer->outputs();
    layers.push_back(std::move(layer));
  };
  const auto add_activation = [&](Activation a) {
    if (a != Activation::identity) add(activation_layer<T>(a, size));
  };
  if (o.frequencies > 0) add(positional_encoding<T>(size, o.frequencies));
  for (const Index width : o.hidden) {
    add(linear<T>(size, width));
    add_activation(o.activation);
    if (o.batch_norm) add(batch_norm<T>(size));
  }
  add(linear<T>(size, outputs));
  add_activation(o.output);
  return sequential<T>(std::move(layers), o.init);
}

UnusedIncludes unused(const MlpOptions& o) {
  UnusedIncludes lines;
  if (!o.batch_norm)
    lines.emplace_back("suite/nn/mlp.cpp", "suite/nn/batch_norm.h");
  if (o.frequencies == 0)
    lines.emplace_back("suite/nn/mlp.cpp", "suite/nn/encoding.h");
  return lines;
}

}  // namespace

NetworkRecipe mlp(const MlpOptions& options) {
  return {.description = "mlp " + in_line(describe(options)),
          .make_float = std::bind_front(make<float>, options),
          .make_double = std::bind_front(make<double>, options),
          .unused = unused(options)};
}

}  // namespace physinv::nn
