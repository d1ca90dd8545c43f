/// Weights by formula, as the reference files describe them.
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "suite/core/network.h"

namespace physinv::test {

/// Numbers of the tensors in the file, in the order of the network's memory.
using TensorNumbers = std::vector<std::size_t>;

inline TensorNumbers numbers_in_order(std::size_t count) {
  TensorNumbers all(count);
  for (std::size_t t = 0; t < count; ++t) all[t] = t;
  return all;
}

/// The U-net's memory is in the order of execution; the files number the way
/// up by the level it leads to. A double convolution has 8 tensors.
inline TensorNumbers unet_numbers(std::size_t levels) {
  constexpr std::size_t kTensors = 8;
  TensorNumbers all;
  const auto add = [&](std::size_t block, std::size_t count) {
    for (std::size_t t = 0; t < count; ++t) all.push_back(block * kTensors + t);
  };
  for (std::size_t block = 0; block < levels; ++block) add(block, kTensors);
  for (std::size_t up = levels - 1; up-- > 0;) add(levels + up, kTensors);
  add(2 * levels - 1, 2);
  return all;
}

/// Entry k of tensor `number`, by its kind (TensorInfo); matrices and kernels
/// are multiplied by `scale`.
inline double formula_weight(char kind,
                             Index fan_in,
                             std::size_t number,
                             Index k,
                             double shift,
                             double scale = 1) {
  const auto t = static_cast<double>(number), fk = static_cast<double>(k);
  switch (kind) {
    case 'b':
      return 0.05 * std::cos(0.9 * fk + 0.4 * t + shift);
    case 's':
      return 1 + 0.1 * std::sin(0.6 * fk + t + shift);
    case 'o':
      return 0.05 * std::cos(0.8 * fk + t + shift);
    default:
      return scale * std::sqrt(3.0 / static_cast<double>(fan_in)) *
             std::sin(0.7 * fk + 1.3 * t + 0.5 + shift);
  }
}

/// The last matrix is multiplied by `last`.
template <class T>
void formula_weights(const std::vector<TensorInfo>& tensors,
                     const TensorNumbers& numbers,
                     double shift,
                     double last,
                     VectorOut<T> parameters) {
  for (std::size_t t = 0; t < tensors.size(); ++t) {
    const TensorInfo& info = tensors[t];
    const double scale = t + 2 == tensors.size() ? last : 1.0;
    for (Index k = 0; k < info.size; ++k)
      parameters(info.offset + k) = static_cast<T>(formula_weight(
          info.kind, info.fan_in, numbers.at(t), k, shift, scale));
  }
}

}  // namespace physinv::test
