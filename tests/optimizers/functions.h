/// Objectives of the optimizer tests, one formula for every problem.
#pragma once

#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

#include "suite/core/batch.h"

namespace physinv::test {

/// The closed-form functions of the reference files, by name: the loss at x,
/// and its gradient. d is free.
inline double closed_form(const std::string& name,
                          const Vector<double>& x,
                          Vector<double>& g) {
  g.setZero(x.size());
  double f = 0;
  if (name == "rosenbrock") {
    for (Index i = 0; i + 1 < x.size(); ++i) {
      const double a = 1 - x(i), b = x(i + 1) - x(i) * x(i);
      f += 100 * b * b + a * a;
      g(i) += -400 * x(i) * b - 2 * a;
      g(i + 1) += 200 * b;
    }
  } else if (name == "wavy") {
    for (Index i = 0; i < x.size(); ++i) {
      f += std::sin(3 * x(i)) + 0.1 * x(i) * x(i);
      g(i) = 3 * std::cos(3 * x(i)) + 0.2 * x(i);
    }
  } else if (name == "quadratic") {
    const double sum = x.sum();
    f = 0.5 * sum * sum;
    for (Index i = 0; i < x.size(); ++i) {
      const double k = 1 + static_cast<double>(i), r = x(i) - 1 / k;
      f += 0.5 * k * r * r;
      g(i) = k * r + sum;
    }
  } else if (name == "well") {
    f = -std::exp(-x.squaredNorm());
    g = -2 * f * x;
  } else if (name == "rough") {
    const double q = 1 + x.squaredNorm();
    f = std::log(q) + 0.3 * std::sin(10 * x(0));
    g = 2 / q * x;
    g(0) += 3 * std::cos(10 * x(0));
  } else if (name == "abs") {
    f = x.cwiseAbs().sum();
    g = x.cwiseSign();
  } else {
    throw std::runtime_error("unknown test function " + name);
  }
  return f;
}

/// The same as a batch objective.
struct ClosedForm {
  std::string name;
  void operator()(std::span<const Index>,
                  BatchIn<double> x,
                  VectorOut<double> loss,
                  BatchOut<double> gradient) const {
    Vector<double> g;
    for (Index i = 0; i < x.cols(); ++i) {
      loss(i) = closed_form(name, x.col(i), g);
      gradient.col(i) = g;
    }
  }
};

/// A single problem given as f(x, gradient) -> loss, as a batch objective. The
/// gradient is zero where f sets none.
template <class F>
auto single(F f) {
  return [f](std::span<const Index>,
             BatchIn<double> x,
             VectorOut<double> loss,
             BatchOut<double> gradient) {
    for (Index i = 0; i < x.cols(); ++i) {
      Vector<double> g = Vector<double>::Zero(x.rows());
      loss(i) = f(Vector<double>(x.col(i)), g);
      gradient.col(i) = g;
    }
  };
}

/// n starting points in [-3, 3]^d without a random generator.
inline Batch<double> starts(Index d, Index n) {
  Batch<double> x(d, n);
  for (Index i = 0; i < x.size(); ++i)
    x(i) = 3 * std::sin(1.3 * static_cast<double>(i * i) + 0.4);
  return x;
}

/// Two billiard balls: cue from (0, 0.5) with velocity x, the other ball of
/// problem i at rest at balls.col(i), target (2, 0.5). Drag 0.4, elasticity
/// 0.8, radius 0.2; a miss has the loss of the resting ball and no gradient.
struct Billiards {
  Batch<double> balls;  // 2 x n
  void operator()(std::span<const Index> active,
                  BatchIn<double> x,
                  VectorOut<double> loss,
                  BatchOut<double> gradient) const {
    using V = Eigen::Vector2d;
    using M = Eigen::Matrix2d;
    const double r = 0.2, mu = 0.4, c = 1.8 / (2 * mu);
    for (Index k = 0; k < x.cols(); ++k) {
      const V v = x.col(k);
      const V ball = balls.col(active[static_cast<std::size_t>(k)]);
      const V d = ball - V(0, 0.5), target(2, 0.5);
      const double dv = d.dot(v), vv = v.squaredNorm();
      const double disc = dv * dv - vv * (d.squaredNorm() - 4 * r * r);
      V final = ball;
      gradient.col(k).setZero();
      if (dv > 0 && disc > 1e-14 * dv * dv) {
        const double s = (dv - std::sqrt(disc)) / vv;
        if (1 - mu * s > 1e-12) {
          const V n = (d - v * s) / (2 * r);
          const double a = std::sqrt(disc) / (2 * r), left = 1 - mu * s;
          const V ds = -(s / a) * n;
          const M dn = -(s * M::Identity() + v * ds.transpose()) / (2 * r);
          const V da = n - (s * v + vv * ds) / (2 * r);
          const V speed = left * da - mu * a * ds;
          final += c * left * a * n;
          const M j = c * (n * speed.transpose() + left * a * dn);
          gradient.col(k) = j.transpose() * (final - target);
        }
      }
      loss(k) = 0.5 * (final - target).squaredNorm();
    }
  }
};

}  // namespace physinv::test
