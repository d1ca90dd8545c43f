#include "optimizers/training/output_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/gradient_check.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

constexpr Index kUnknowns = 5, kObservations = 3, kSamples = 4;
constexpr double kScale = 0.7;
constexpr OutputForm kForms[] = {
    OutputForm::linear, OutputForm::box, OutputForm::mean_of_observations};

/// Some numbers between -1 and 1.
Batch<double> numbers(Index rows, Index cols, double seed) {
  Batch<double> all(rows, cols);
  for (Index k = 0; k < all.size(); ++k)
    all.data()[k] = std::sin(seed + 1.7 * static_cast<double>(k));
  return all;
}

const Batch<double> kOut = numbers(kUnknowns, kSamples, 0.3);
const Batch<double> kY = numbers(kObservations, kSamples, 0.9);
const Vector<double> kStart = numbers(kUnknowns, 1, 0.1);

template <class T>
Batch<T> mapped(OutputMap<T>& map, const Batch<double>& out) {
  Batch<T> x(kUnknowns, kSamples);
  map(out.template cast<T>(), kY.template cast<T>(), x);
  return x;
}

// With every start, the level ones that take a path of their own, too.
TEST(OutputMap, PullsBackExactly) {
  const Batch<double> x_bar = numbers(kUnknowns, kSamples, 2.1);
  for (const OutputForm form : kForms) {
    for (const Vector<double>& start :
         {kStart, Vector<double>::Constant(kUnknowns, 0.4).eval()}) {
      SCOPED_TRACE(static_cast<int>(form));
      const auto map = output_map<double>(form, kScale, start);
      const Vector<double> expected = difference_gradient(
          [&](const Vector<double>& flat) {
            const Eigen::Map<const Batch<double>> out(
                flat.data(), kUnknowns, kSamples);
            return mapped<double>(*map, out).cwiseProduct(x_bar).sum();
          },
          kOut.reshaped());
      mapped<double>(*map, kOut);
      Batch<double> bar = x_bar;
      map->pull_back(bar);
      EXPECT_TRUE(
          Comparator(1e-8, 1e-9)(Vector<double>(bar.reshaped()), expected));

      const auto single = output_map<float>(form, kScale, start);
      EXPECT_TRUE(Comparator(1e-6, 1e-6)(
          Batch<double>(mapped<float>(*single, kOut).cast<double>()),
          mapped<double>(*map, kOut)));
      Batch<float> bar_single = x_bar.cast<float>();
      single->pull_back(bar_single);
      EXPECT_TRUE(Comparator(1e-5, 1e-6)(
          Batch<double>(bar_single.cast<double>()), bar));
    }
  }
}

// A row of a Jacobian goes back like a gradient.
TEST(OutputMap, PullsRowsOfJacobiansBack) {
  const Batch<double> rows = numbers(kObservations * kUnknowns, kSamples, 1.2);
  for (const OutputForm form : kForms) {
    SCOPED_TRACE(static_cast<int>(form));
    const auto map = output_map<double>(form, kScale, kStart);
    mapped<double>(*map, kOut);
    Batch<double> pulled = rows;
    map->pull_back_rows(pulled);
    for (Index r = 0; r < kObservations; ++r) {
      const auto of = [r](const Batch<double>& all) -> Batch<double> {
        return all(Eigen::seqN(r, kUnknowns, kObservations), Eigen::all);
      };
      Batch<double> bar = of(rows);
      map->pull_back(bar);
      EXPECT_TRUE(Comparator(1e-14, 1e-15)(of(pulled), bar));
    }
  }
}

TEST(OutputMap, KeepsWhatItsFormPromises) {
  const auto linear = output_map<double>(OutputForm::linear, kScale, kStart);
  const Batch<double> x = mapped<double>(*linear, kOut);
  EXPECT_TRUE(Comparator(1e-14, 1e-15)(linear->outputs_of(x), kOut));

  const auto box = output_map<double>(OutputForm::box, kScale, kStart);
  const Batch<double> far = mapped<double>(*box, 1e3 * kOut).colwise() - kStart;
  EXPECT_LE(far.cwiseAbs().maxCoeff(), kScale * (1 + 1e-14));
  EXPECT_GT(far.cwiseAbs().maxCoeff(), 0.99 * kScale);

  const auto mean =
      output_map<double>(OutputForm::mean_of_observations, kScale, kStart);
  EXPECT_TRUE(Comparator(1e-13, 1e-15)(
      Vector<double>(mapped<double>(*mean, kOut).colwise().mean()),
      Vector<double>(kY.colwise().mean())));
}

}  // namespace
}  // namespace physinv::test
