// Powers of tall Jacobians without a Gram matrix, and their parts.
#include "optimizers/half_inverse/tall_power.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "suite/linalg/pivoted_qr.h"
#include "tests/optimizers/half_inverse_truth.h"

namespace physinv::hig {

using namespace linalg;

namespace {

Batch<double> with_values(Index rows, const Vector<double>& s) {
  return orthonormal(rows, s.size(), 1) * s.asDiagonal() *
         orthonormal(s.size(), s.size(), 2).transpose();
}

Vector<double> values(Index n, double decades) {
  return Vector<double>::NullaryExpr(n, [=](Index i) {
    const double x = (static_cast<double>(i) + 0.3) / static_cast<double>(n);
    return 7 * std::pow(10, -decades * x);
  });
}

TallColumns columns_of(const Batch<double>& j, const Vector<double>& g) {
  TallColumns a;
  a.open(j.rows(), j.cols() + 1);
  for (Index c = 0; c < j.cols(); ++c)
    std::copy_n(j.col(c).data(), j.rows(), a.column(c));
  std::copy_n(g.data(), g.size(), a.column(j.cols()));
  return a;
}

TEST(TallQr, HasTheSameProducts) {
  for (const Index rows : {9, 24, 101, 256})
    for (const Index pivots : {1, 3, 4, 9}) {
      Batch<double> j = noise(rows, pivots + 2, 3);
      for (Index c = 0; c < j.cols(); ++c)
        j.col(c) *= std::pow(10, -2.0 * static_cast<double>(c));
      TallColumns a = columns_of(j.leftCols(pivots + 1), j.col(pivots + 1));
      Batch<double> r(pivots, pivots + 2);
      triangularize(a, pivots, r);
      for (Index c = 0; c < pivots; ++c) {
        EXPECT_TRUE(r.col(c).tail(pivots - c - 1).isZero(0));
        for (Index k = 0; k < j.cols(); ++k)
          EXPECT_NEAR(r.col(c).dot(r.col(k)),
                      j.col(c).dot(j.col(k)),
                      1e-14 * j.col(c).norm() * j.col(k).norm());
      }
    }
}

TEST(PivotedQr, GivesTheMatrixBack) {
  for (const Index rows : {9, 24, 101})
    for (const Index columns : {1, 3, 9}) {
      Batch<double> a = noise(rows, columns, 3);
      for (Index c = 0; c < columns; ++c)
        a.col(c) *= std::pow(10, -2.0 * static_cast<double>((5 * c) % 9));
      if (columns > 3) a.col(2) = a.col(1);  // of rank columns - 1
      const PivotedQr qr(a);
      Batch<double> product = Batch<double>::Zero(rows, columns);
      product.topRows(columns) = qr.r();
      qr.apply_q(product);
      std::set<Index> seen;
      for (Index c = 0; c < columns; ++c) {
        seen.insert(qr.order(c));
        const auto column = a.col(qr.order(c));
        EXPECT_LE((product.col(c) - column).norm(), 2e-15 * a.norm());
        EXPECT_TRUE(qr.r().col(c).tail(columns - c - 1).isZero(0));
        for (Index later = c + 1; later < columns; ++later)
          EXPECT_LE(qr.r().col(later).segment(c, later - c + 1).norm(),
                    std::abs(qr.r()(c, c)) * (1 + 1e-7));
      }
      EXPECT_EQ(static_cast<Index>(seen.size()), columns);
      qr.apply_q_transposed(product);
      EXPECT_LE((product.topRows(columns) - qr.r()).norm(), 2e-15 * a.norm());
    }
}

TEST(Bidiagonal, IsAnOrthogonalTransform) {
  for (const Index n : {1, 2, 7, 30, 33, 70}) {
    const Batch<double> r = noise(n, n, 4);
    const Vector<double> h = noise(n, 1, 5);
    Bidiagonal form;
    form.reduce(r, h);
    EXPECT_NEAR(std::abs(form.alpha()), h.norm(), 1e-14 * h.norm());
    Batch<double> l = Batch<double>::Zero(n, n), q(n, n);
    l.diagonal() = form.diagonal();
    if (n > 1) l.diagonal(-1) = form.below();
    q.setIdentity();
    for (Index c = 0; c < n; ++c) {
      VectorOut<double> column(q.col(c));
      form.apply(column);
    }
    EXPECT_LE((q.transpose() * q - Batch<double>::Identity(n, n)).norm(),
              1e-14 * static_cast<double>(n));
    // R = P L Q^T, P^T h = alpha e1: no P in R^T R, its first column in R^T h.
    EXPECT_LE(
        (r.transpose() * r - q * l.transpose() * l * q.transpose()).norm(),
        1e-13 * r.squaredNorm());
    EXPECT_LE(
        (r.transpose() * h - form.alpha() * q * l.row(0).transpose()).norm(),
        1e-13 * r.norm() * h.norm());
  }
}

TEST(TallPower, AgainstTheDefinition) {
  Index checked = 0;
  for (const double decades : {2.0, 5.0, 9.0, 13.0})
    for (const Index n : {1, 5, 30, 47}) {
      const Batch<double> j = with_values(n + 40, values(n, decades));
      const Vector<double> g = noise(j.rows(), 1, 6);
      for (const Power& p : {Power{.kappa = -0.5, .tau = 1.7e-6},
                             Power{.kappa = -1, .tau = 1.7e-4},
                             Power{.kappa = 0.25, .tau = 1.7e-3}}) {
        TallPower power;
        TallColumns a = columns_of(j, g);
        Vector<double> update(n);
        const PowerReport report = power(a, p, update);
        const Vector<double> expected = Definition(j, g).update(p);
        EXPECT_EQ(report.ending, Ending::ok);
        EXPECT_LE((update - expected).norm(),
                  (report.error + 1e-12) * expected.norm())
            << n << " columns, " << decades << " decades, kappa " << p.kappa
            << ", error " << report.error;
        EXPECT_LE((update - expected).norm(), 1e-8 * expected.norm());
        EXPECT_LT(report.error, 1e-6);
        EXPECT_EQ(power.spared(), power.fallbacks() == 0);
        EXPECT_FALSE(power.spared() && power.abandoned());
        checked += power.fallbacks() == 0;
      }
    }
  EXPECT_GE(checked, 44);  // of 48 by lanes
}

// Equal values have no vectors of their own: the other way must take over.
TEST(TallPower, ValuesThatCoincide) {
  for (const double apart : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
    Vector<double> s = values(20, 5);
    s(4) = s(3) * (1 - apart), s(11) = s(12) * (1 + apart);
    const Batch<double> j = with_values(64, s);
    const Vector<double> g = noise(64, 1, 7);
    const Power p{.kappa = -0.5, .tau = 1.7e-4};
    TallPower power;
    TallColumns a = columns_of(j, g);
    Vector<double> update(20);
    EXPECT_EQ(power(a, p, update).ending, Ending::ok);
    const Vector<double> expected = Definition(j, g).update(p);
    EXPECT_LE((update - expected).norm(), 1e-9 * expected.norm()) << apart;
    EXPECT_EQ(power.abandoned(), power.fallbacks() == 1) << apart;
    EXPECT_TRUE(apart > 0 || power.abandoned());
  }
}

TEST(TallPower, WhatIsZeroAndWhatIsNot) {
  const Power p{.kappa = -0.5, .tau = 1e-6};
  const Batch<double> j = with_values(40, values(6, 2));
  Vector<double> g = noise(40, 1, 8), update(6);
  TallPower power;
  TallColumns a = columns_of(j, Vector<double>::Zero(40));
  EXPECT_EQ(power(a, p, update).ending, Ending::zero);
  EXPECT_TRUE(update.isZero(0));
  a = columns_of(Batch<double>::Zero(40, 6), g);
  EXPECT_EQ(power(a, p, update).ending, Ending::zero);
  EXPECT_TRUE(update.isZero(0));
  Batch<double> gap = j;
  gap.col(2).setZero(), gap.col(5).setZero();
  a = columns_of(gap, g);
  EXPECT_EQ(power(a, p, update).ending, Ending::ok);
  EXPECT_LE((update - Definition(gap, g).update(p)).norm(),
            1e-11 * update.norm());
  EXPECT_LE(std::abs(update(2)), 1e-15 * update.norm());
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    Batch<double> spoiled = j;
    spoiled(39, 5) = bad;
    a = columns_of(spoiled, g);
    EXPECT_EQ(power(a, p, update).ending, Ending::nonfinite);
    Vector<double> wild = g;
    wild(7) = bad;
    a = columns_of(j, wild);
    EXPECT_EQ(power(a, p, update).ending, Ending::nonfinite);
  }
}

}  // namespace
}  // namespace physinv::hig
