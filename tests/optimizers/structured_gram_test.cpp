// J J^T of a network without J.
#include "optimizers/half_inverse/structured_gram.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "suite/core/check.h"
#include "tests/optimizers/half_inverse_truth.h"

namespace physinv::hig {
namespace {

/// J of a network from its definition: rows (a outer B, B).
template <class T>
void structured_gram(Index samples, Index rows) {
  struct Layer {
    Index in, out;
    Index positions = 1, channels = 0;  ///< a patch moves by so many inputs
    Index all_in() const { return (positions - 1) * channels + in; }
  };
  // The convolutions: one by its columns, one by pairs, and one so wide that
  // the layers are taken in several groups.
  const std::vector<Layer> shape = {{3, 20},
                                    {6, 5, 9, 2},
                                    {12, 5, 2, 4},
                                    {20, 7},
                                    {60, 21, 8, 20},
                                    {6, 5, 3, 2},
                                    {1, 1}};
  const Index m = samples * rows;
  std::vector<Batch<T>> data;
  std::vector<LayerRows<T>> layers;
  Batch<double> j(m, 0);
  for (const Layer& l : shape) {
    data.push_back(noise(samples + 3, l.all_in(), 130).template cast<T>());
    data.push_back(noise(m + 5, l.positions * l.out, 131).template cast<T>());
  }
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const Batch<T>&a = data[2 * i], &b = data[2 * i + 1];
    layers.push_back({.offset = 0,
                      .inputs = shape[i].in,
                      .outputs = shape[i].out,
                      .a = a.data(),
                      .a_stride = a.rows(),
                      .b = b.data(),
                      .b_stride = b.rows(),
                      .positions = shape[i].positions,
                      .a_step = shape[i].channels,
                      .b_step = shape[i].out});
    for (Index in = 0; in < shape[i].in + 1; ++in)
      for (Index out = 0; out < shape[i].out; ++out) {
        j.conservativeResize(m, j.cols() + 1);
        for (Index r = 0; r < m; ++r) {
          double sum = 0;
          for (Index p = 0; p < shape[i].positions; ++p)
            sum +=
                static_cast<double>(b(r, p * shape[i].out + out)) *
                (in < shape[i].in ? static_cast<double>(
                                        a(r / rows, p * shape[i].channels + in))
                                  : 1.0);
          j(r, j.cols() - 1) = sum;
        }
      }
  }
  const Batch<double> expected = j * j.transpose();
  Batch<double> g = Batch<double>::Constant(m, m, 7), threaded = g;
  StructuredGram gram;
  gram.template operator()<T>(layers, samples, rows, g);
  Threads threads(3);
  gram.template operator()<T>(layers, samples, rows, threaded, &threads);
  EXPECT_TRUE(g == threaded);
  for (Index c = 0; c < m; ++c)
    for (Index r = 0; r < m; ++r) {
      if (r < c) {
        ASSERT_EQ(g(r, c), 7);
      } else {
        ASSERT_NEAR(
            g(r, c), expected(r, c), 1e-13 * expected.diagonal().maxCoeff())
            << samples << " x " << rows << ": " << r << ", " << c;
      }
    }
}

TEST(StructuredGram, EqualsTheExplicitProduct) {
  for (const auto& [samples, rows] : std::vector<std::pair<Index, Index>>{
           {1, 1}, {1, 5}, {40, 1}, {9, 2}, {33, 4}, {3, 28}, {5, 64}}) {
    structured_gram<double>(samples, rows);
    structured_gram<float>(samples, rows);
  }
}

}  // namespace
}  // namespace physinv::hig
