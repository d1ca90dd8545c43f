#include "suite/nn/gemm.h"

#include <gtest/gtest.h>

#include "suite/nn/activation.h"
#include "suite/nn/thin_product.h"
#include "tests/suite/nn/nn_testing.h"

namespace physinv::nn {
namespace {

template <class T>
class GemmTest : public testing::Test {};
using Types = testing::Types<float, double>;

/// C = A B; columns of a, b and c are rows of A, B and C.
template <class T>
Gemm<T> product(const Batch<T>& a, const Batch<T>& b, Index n, Batch<T>& c) {
  return {.m = c.cols(),
          .n = n,
          .k = a.rows(),
          .a = a.data(),
          .a_row = a.rows(),
          .a_k = 1,
          .b = b.data(),
          .b_stride = b.rows(),
          .c = c.data(),
          .c_stride = c.rows()};
}

/// A batch as lanes, in memory that held something else.
template <class T>
struct RowsCopy {
  explicit RowsCopy(const Batch<T>& in) : lanes(nullptr, in.rows(), in.cols()) {
    memory.setConstant(lanes.stride, in.rows(), T(7));
    lanes.data = memory.data();
    to_rows<T>(in, lanes);
  }
  Rows<T> lanes;
  Batch<T> memory;
};

TYPED_TEST_SUITE(GemmTest, Types);

/// Every size class of tile, against the definition, term by term in order.
TYPED_TEST(GemmTest, EqualsTheSequentialSumBitwise) {
  using T = TypeParam;
  for (const Index m : {1, 2, 5, 7, 17, 40}) {
    for (const Index n : {1, 3, 8, 13, 16, 24, 37, 64}) {
      for (const Index k : {0, 1, 2, 19, 300, 520}) {
        const Index stride = row_stride<T>(round_up(n, kNarrowLanes<T>));
        const Batch<T> a = wavy<T>(k, m), b = wavy<T>(stride, k, 0.3);
        const Vector<T> bias = wavy<T>(m, 1, 0.7);
        // One more column: nothing may be written behind the last.
        Batch<T> c = Batch<T>::Constant(n + 1, m, T(9)), expected = c;
        Gemm<T> g = product(a, b, n, c);
        g.bias = bias.data(), g.activation = Activation::relu;
        gemm(g);
        for (Index i = 0; i < m; ++i) {
          for (Index j = 0; j < n; ++j) {
            T sum = bias(i);
            for (Index q = 0; q < k; ++q) sum = std::fma(a(q, i), b(j, q), sum);
            expected(j, i) = activate(Activation::relu, sum);
          }
        }
        ASSERT_TRUE((c.array() == expected.array()).all())
            << m << " " << n << " " << k;
      }
    }
  }
}

TYPED_TEST(GemmTest, TransposedAndGated) {
  using T = TypeParam;
  struct Size {
    Index m, k;
  };
  for (const auto& [m, k] : {Size{29, 33}, Size{7, 2}}) {
    for (const Activation f : {Activation::relu, Activation::tanh}) {
      const Index n = 40, stride = row_stride<T>(n);
      const Batch<T> a = wavy<T>(m, k), b = wavy<T>(stride, k, 0.3);
      const Batch<T> gate = wavy<T>(stride, m, 0.9);
      Batch<T> c(stride, m);
      gemm<T>({.m = m,
               .n = n,
               .k = k,
               .a = a.data(),
               .a_row = 1,
               .a_k = m,
               .b = b.data(),
               .b_stride = stride,
               .c = c.data(),
               .c_stride = stride,
               .gate_activation = f,
               .gate = gate.data(),
               .gate_stride = stride});
      for (Index i = 0; i < m; ++i) {
        for (Index j = 0; j < n; ++j) {
          T sum = 0;
          for (Index q = 0; q < k; ++q) sum = std::fma(a(i, q), b(j, q), sum);
          ASSERT_EQ(c(j, i), sum * derivative(f, gate(j, i)));
        }
      }
    }
  }
}

/// A few rows by themselves, and the same ones among many.
TYPED_TEST(GemmTest, ThinProductsHaveTheBitsOfTiles) {
  using T = TypeParam;
  const Index few = 7, many = 40, k = 2;
  const Batch<T> a = wavy<T>(k, many);
  const Vector<T> bias = wavy<T>(many, 1, 0.7);
  for (const Activation f : {Activation::tanh, Activation::sigmoid}) {
    for (const Index n : {3, 8, 37, 64}) {
      const Index stride = row_stride<T>(round_up(n, kNarrowLanes<T>));
      const Batch<T> b = wavy<T>(stride, k, 0.3);
      Batch<T> thin = Batch<T>::Constant(n + 1, few, T(9));
      Batch<T> tiles = Batch<T>::Constant(n + 1, many, T(9));
      for (Batch<T>* c : {&thin, &tiles}) {
        Gemm<T> g = product(a, b, n, *c);
        g.bias = bias.data(), g.activation = f;
        ASSERT_EQ(is_thin(g), c == &thin);
        gemm(g);
      }
      expect_same_bits(thin, Batch<T>(tiles.leftCols(few)));
    }
  }
}

TYPED_TEST(GemmTest, RowProductsAreSumsOverSamples) {
  using T = TypeParam;
  for (const Index n : {1, 8, 37, 64}) {
    const Batch<T> in = wavy<T>(2, n), bar = wavy<T>(7, n, 0.4);
    RowsCopy<T> x(in), y(bar);
    if (n < x.lanes.width) x.lanes.data[n] = T(3);  // as an activation's
    Batch<T> out = Batch<T>::Constant(3, 7, T(9));
    row_products<T>(x.lanes, y.lanes, out.data(), 1, 3);
    const Batch<T> expected = in * bar.transpose();
    EXPECT_LE((out.topRows(2) - expected).norm(), 1e-5);
    EXPECT_TRUE((out.row(2).array() == T(9)).all());
  }
}

TYPED_TEST(GemmTest, ThreadsDoNotChangeBits) {
  using T = TypeParam;
  const Index m = 131, n = 128, k = 90, stride = row_stride<T>(n);
  const Batch<T> a = wavy<T>(k, m), b = wavy<T>(stride, k);
  Batch<T> one(stride, m), three(stride, m);
  one.setZero(), three.setZero();
  gemm(product(a, b, n, one));
  Threads threads(3);
  gemm(product(a, b, n, three), &threads);
  expect_same_bits(one, three);
}

TYPED_TEST(GemmTest, LanesTransposeBothWays) {
  using T = TypeParam;
  for (const Index rows : {1, 4, 9, 32}) {
    for (const Index n : {1, 8, 11, 40}) {
      const Batch<T> in = wavy<T>(rows, n);
      const RowsCopy<T> copy(in);
      const Rows<T>& x = copy.lanes;
      Batch<T> out(rows, n);
      for (Index i = 0; i < rows; ++i)
        for (Index j = 0; j < x.width; ++j)
          ASSERT_EQ(x.row(i)[j], j < n ? in(i, j) : T(0));
      from_rows<T>(x, out);
      expect_same_bits(in, out);
      const Index up = round_up(n, kNarrowLanes<T>);
      Batch<T> padded = Batch<T>::Constant(up + 1, rows, T(7));
      transpose(in.data(), rows, n, rows, padded.data(), up + 1, Behind::zeros);
      for (Index i = 0; i < rows; ++i)
        for (Index j = 0; j <= up; ++j)
          ASSERT_EQ(padded(j, i), j < n ? in(i, j) : T(j < up ? 0 : 7));
      Vector<T> sums(rows);
      row_sums<T>(x, sums.data());
      EXPECT_LE((sums - in.rowwise().sum()).norm(), 1e-5);
    }
  }
}

}  // namespace
}  // namespace physinv::nn
