// What a network promises in addition to its numbers: bits, reuse, memory.

#include "suite/nn/sequential.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "optimizers/steps/adam.h"
#include "suite/core/check.h"
#include "suite/core/threads.h"
#include "suite/nn/mlp.h"
#include "tests/suite/nn/nn_testing.h"

namespace {
std::atomic<long> allocations{0};
}  // namespace

[[gnu::noinline]] void* operator new(std::size_t bytes) {
  ++allocations;
  if (void* p = std::malloc(bytes)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

namespace physinv::nn {
namespace {

template <class T>
class SequentialTest : public testing::Test {
 protected:
  const NetworkRecipe recipe_ = mlp({.hidden = {37, 40}, .frequencies = 3});
};
using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(SequentialTest, Types);

template <class T>
Batch<T> columns(const Batch<T>& all, const std::vector<Index>& which) {
  return all(Eigen::all, which);
}

TYPED_TEST(SequentialTest, SamplesAreIndependentBitwise) {
  using T = TypeParam;
  for (const Activation a : {Activation::relu, Activation::tanh}) {
    Bench<T> b(mlp({.hidden = {37, 40},
                    .frequencies = 3,
                    .activation = a,
                    .batch_norm = a == Activation::tanh}),
               4,
               3);
    const Batch<T> in = wavy<T>(4, 37), out_bar = wavy<T>(3, 37, 1.0);
    const Batch<T> out = b.forward(in);
    const Batch<T> in_bar = b.in_bar(out_bar);
    std::vector<std::vector<Index>> subsets;
    for (Index j = 0; j < 37; ++j) subsets.push_back({j});
    subsets.push_back({5, 3, 36, 0, 17, 2, 11, 9, 30});
    std::vector<Index> reversed;
    for (Index j = 37; j-- > 0;) reversed.push_back(j);
    subsets.push_back(reversed);
    for (const auto& some : subsets) {
      expect_same_bits(b.forward(columns(in, some)), columns(out, some));
      expect_same_bits(b.in_bar(columns(out_bar, some)), columns(in_bar, some));
    }
  }
}

TYPED_TEST(SequentialTest, ThreadsDoNotChangeBits) {
  using T = TypeParam;
  const NetworkRecipe wide = mlp({.hidden = {130, 128, 128}, .frequencies = 4});
  Threads threads(3);
  Bench<T> one(wide, 4, 2), three(wide, 4, 2, &threads);
  const Batch<T> in = wavy<T>(4, 100), out_bar = wavy<T>(2, 100);
  expect_same_bits(one.forward(in), three.forward(in));
  expect_same_bits(one.parameters_bar(out_bar), three.parameters_bar(out_bar));
  expect_same_bits(one.in_bar(out_bar), three.in_bar(out_bar));
}

/// Two of four inputs are constant: 6 leading and 6 trailing features.
template <class T>
Batch<T> partly_constant(Index n) {
  Batch<T> in = wavy<T>(4, n);
  in.row(0).setConstant(T(1));
  in.row(3).setConstant(T(0.5));
  return in;
}

TYPED_TEST(SequentialTest, FoldingDiffersByRoundingOnly) {
  using T = TypeParam;
  const Index n = 21;
  Bench<T> full(this->recipe_, 4, 2), fold(this->recipe_, 4, 2);
  const Batch<T> in = partly_constant<T>(n), out_bar = wavy<T>(2, n);
  const double tol = sizeof(T) == 4 ? 1e-5 : 1e-12;
  EXPECT_LE((full.forward(in) - fold.forward(in, {.fixed_input = true}))
                .cwiseAbs()
                .maxCoeff(),
            tol);
  EXPECT_EQ(fold.work.counts[Counter::skipped_rows], 12U * n);
  const Vector<T> bar = full.parameters_bar(out_bar);
  EXPECT_LE((bar - fold.parameters_bar(out_bar)).cwiseAbs().maxCoeff(),
            tol * double(bar.cwiseAbs().maxCoeff()));
  // All rows constant, and a batch of one.
  EXPECT_LE((full.forward(in.leftCols(1)) -
             fold.forward(in.leftCols(1), {.fixed_input = true}))
                .cwiseAbs()
                .maxCoeff(),
            tol);
  fold.parameters_bar(out_bar.leftCols(1));
}

TYPED_TEST(SequentialTest, SameInputSkipsTheEncodingAndKeepsBits) {
  using T = TypeParam;
  const Index n = 9;
  for (const bool fixed : {false, true}) {
    Bench<T> b(this->recipe_, 4, 2);
    const Batch<T> in = partly_constant<T>(n), out_bar = wavy<T>(2, n);
    const Batch<T> first = b.forward(in, {.fixed_input = fixed});
    const Vector<T> bar = b.parameters_bar(out_bar);
    EXPECT_EQ(b.work.counts[Counter::skipped_features], 0U);
    const Pass again{.same_input = true, .fixed_input = fixed};
    expect_same_bits(b.forward(in, again), first);
    expect_same_bits(b.parameters_bar(out_bar), bar);
    EXPECT_EQ(b.work.counts[Counter::skipped_features], std::uint64_t(n));
    EXPECT_THROW(b.forward(in.leftCols(3), again), ContractError);
    // Fixing it later gives the bits of having fixed it at once.
    Bench<T> late(this->recipe_, 4, 2), soon(this->recipe_, 4, 2);
    late.forward(in);
    expect_same_bits(
        late.forward(in, {.same_input = true, .fixed_input = true}),
        soon.forward(in, {.fixed_input = true}));
  }
}

TYPED_TEST(SequentialTest, AllocatesNothingAfterTheFirstStep) {
  using T = TypeParam;
  Bench<T> b(
      mlp({.hidden = {64, 64}, .frequencies = 2, .batch_norm = true}), 4, 2);
  const Batch<T> in = partly_constant<T>(24), out_bar = wavy<T>(2, 24);
  Batch<T> out(2, 24), in_bar(4, 24);
  Vector<T> bar(b.p.size());
  VectorOut<T> bar_ref(bar);
  BatchOut<T> in_ref(in_bar);
  Adam<T> adam;
  Pass pass{.training = true, .fixed_input = true};
  const auto step = [&] {
    b.net->forward(b.p, b.s, in, out, b.tape, b.work, pass);
    b.net->backward(b.p, b.tape, out_bar, &bar_ref, &in_ref, b.work);
    b.net->update_state(b.tape, b.s);
    adam.step(b.p, bar);
  };
  step();
  step();
  const std::size_t bytes = b.tape.bytes() + b.work.bytes();
  const long before = allocations;
  for (int i = 0; i < 3; ++i) step();
  pass.same_input = true;
  step();
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(b.tape.bytes() + b.work.bytes(), bytes);
}

TEST(Sequential, RefusesLayersThatDoNotFit) {
  EXPECT_THROW(sequential<double>({}), ContractError);
  Bench<double> b(mlp({.hidden = {4}}), 3, 2);
  EXPECT_THROW(b.forward(wavy<double>(2, 5)), ContractError);
  EXPECT_THROW(b.forward(wavy<double>(3, 5), {.same_input = true}),
               ContractError);
}

}  // namespace
}  // namespace physinv::nn
