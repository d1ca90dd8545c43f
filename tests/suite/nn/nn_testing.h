/// A network with its vectors, for tests.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "suite/core/network.h"
#include "suite/nn/sequential.h"

namespace physinv::nn {

/// Layers one after the other.
template <class T, class... Behind>
Layers<T> layers(LayerPointer<T> first, Behind... behind) {
  Layers<T> all;
  all.push_back(std::move(first));
  (all.push_back(std::move(behind)), ...);
  return all;
}

/// A network of the layers that make<T>() gives, the same in both precisions.
template <class F>
NetworkRecipe network(F make, Init init = Init::fan_in) {
  return {
      .description = "layers",
      .make_float =
          [=](Index, Index) {
            return sequential<float>(make.template operator()<float>(), init);
          },
      .make_double =
          [=](Index, Index) {
            return sequential<double>(make.template operator()<double>(), init);
          }};
}

template <class T>
struct Bench {
  Bench(const NetworkRecipe& recipe,
        Index inputs,
        Index outputs,
        Threads* threads = nullptr)
      : net(recipe.make<T>(inputs, outputs)),
        p(net->parameter_count()),
        s(net->state_count()),
        work(threads) {
    net->initialize(Rng::root("nn_test", 1), p, s);
    // Biases and scales that are not zero and one.
    for (Index i = 0; i < p.size(); ++i)
      p(i) += static_cast<T>(0.05 * std::cos(0.9 * double(i)));
  }

  Batch<T> forward(const Batch<T>& in, Pass pass = {}) {
    Batch<T> out(net->outputs(), in.cols());
    net->forward(p, s, in, out, tape, work, pass);
    return out;
  }
  Vector<T> parameters_bar(const Batch<T>& out_bar) {
    Vector<T> bar = Vector<T>::Constant(p.size(), std::nan(""));
    VectorOut<T> ref(bar);
    net->backward(p, tape, out_bar, &ref, nullptr, work);
    return bar;
  }
  Batch<T> in_bar(const Batch<T>& out_bar) {
    Batch<T> bar =
        Batch<T>::Constant(net->inputs(), out_bar.cols(), std::nan(""));
    BatchOut<T> ref(bar);
    net->backward(p, tape, out_bar, nullptr, &ref, work);
    return bar;
  }

  std::unique_ptr<Network<T>> net;
  Vector<T> p, s;
  Tape tape;
  Workspace work;
};

/// Smooth numbers in (-1, 1) that repeat nowhere.
template <class T>
Batch<T> wavy(Index rows, Index cols, double shift = 0) {
  return Batch<T>::NullaryExpr(rows, cols, [=](Index i, Index j) {
    return static_cast<T>(
        std::sin(1.7 * double(i) + 0.61 * double(j * (j + 1)) + shift));
  });
}

template <class M>
void expect_same_bits(const M& a, const M& b) {
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.cols(), b.cols());
  EXPECT_TRUE((a.array() == b.array()).all());
}

}  // namespace physinv::nn
