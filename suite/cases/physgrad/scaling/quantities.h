/// What claims and figures read from records: the trajectory of a problem of a
/// run, and numbers of single steps, from the arrays that the stage
/// `identities` leaves.
#pragma once

#include <cmath>
#include <functional>

#include "suite/core/math.h"
#include "suite/evidence/run_values.h"
#include "suite/store/record.h"

namespace physinv::scaling {

/// The recorded trajectory of one problem of a run.
class Path {
 public:
  Path(const StageRecord& stage, Index problem = 0)
      : x_(stage.arrays.at("path").middleRows(2 * problem, 2)) {}

  /// Problems with a recorded path.
  static Index count(const StageRecord& stage) {
    const auto found = stage.arrays.find("path");
    return found == stage.arrays.end() ? 0 : found->second.rows() / 2;
  }

  Index steps() const { return x_.cols() - 1; }
  const Batch<double>& x() const { return x_; }
  /// y of the comparison.
  Batch<double> squared() const {
    Batch<double> y = x_;
    y.row(1) = x_.row(1).cwiseAbs2();
    return y;
  }
  double distance() const {
    return math::hypot(x_(0, steps()), x_(1, steps()));
  }
  /// The first update along the diagonal, sqrt 2 at most; NaN without one.
  double diagonal() const {
    const Vector<double> u = x_.col(0) - x_.col(1);
    return u.sum() / math::hypot(u(0), u(1));
  }

 private:
  Batch<double> x_;
};

// ---- single steps -----------------------------------------------------------

using OfArray = std::function<double(const Batch<double>&)>;
inline Quantity identity(ArrayKey array, const OfArray& value) {
  return median({"identities"}, of_array(array, value));
}
/// Log-log slope between the largest dy and the smallest.
inline double slope(const Batch<double>& order) {
  return math::log(order(1, 0) / order(1, 5)) /
         math::log(order(0, 0) / order(0, 5));
}
inline double gd_off(const Batch<double>& linear) {
  return ((linear.row(1).array() / linear.row(0).array().square()) + 0.1)
      .abs()
      .maxCoeff();
}
inline double ig_off(const Batch<double>& linear) {
  return (linear.row(2).array() + 0.1).abs().maxCoeff();
}
inline double root_off(const Batch<double>& roots) {
  return (roots.row(2).array().square() - roots.row(0).array())
      .abs()
      .maxCoeff();
}
inline double wrong_branch(const Batch<double>& roots) {
  return static_cast<double>(
      (roots.row(2).array() * roots.row(1).array() <= 0).count());
}

/// What a step's row reaches of the asked change of y: largest over smallest.
inline OfArray spread_of_row(Index row) {
  return [row](const Batch<double>& inner) {
    return inner.row(row).maxCoeff() / inner.row(row).minCoeff();
  };
}
inline double off_the_mean(const Batch<double>& average) {
  return (average.row(1).array() / average.row(2).array() - 1).abs().maxCoeff();
}
/// Of the local gradient at the start, which a small step comes near.
inline double off_the_start(const Batch<double>& average) {
  return average(1, average.cols() - 1) * 6 - 1;
}
/// Of moves on this side of 0, or beyond it.
inline OfArray inverse_off(bool near) {
  return [near](const Batch<double>& local) {
    const auto half = local.cols() / 2;
    return near ? local.row(1).tail(half).maxCoeff()
                : local.row(1).head(half).minCoeff();
  };
}
inline double quotients_lost(const Batch<double>& singular) {
  return static_cast<double>((singular.row(1).array() != 1).count());
}
inline double steps_lost(const Batch<double>& singular) {
  return static_cast<double>((singular.row(2).array() != 1).count());
}
/// At the smallest alpha over that at 1.
inline OfArray share_at_small(Index row) {
  return [row](const Batch<double>& small) {
    return small(row, small.cols() - 1) / small(row, 0);
  };
}
inline double reversal_order(const Batch<double>& reversed) {
  const Index last = reversed.cols() - 1;
  return math::log2(reversed(1, last - 1) / reversed(1, last));
}
inline double reversal_end(const Batch<double>& reversed) {
  return reversed(1, reversed.cols() - 1);
}

}  // namespace physinv::scaling
