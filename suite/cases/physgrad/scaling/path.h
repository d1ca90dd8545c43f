/// The recorded trajectory of one problem of a run.
#pragma once

#include "suite/store/record.h"

namespace physinv::scaling {

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
  double distance() const { return std::hypot(x_(0, steps()), x_(1, steps())); }
  /// The first update along the diagonal, sqrt 2 at most; NaN without one.
  double diagonal() const {
    const Vector<double> u = x_.col(0) - x_.col(1);
    return u.sum() / std::hypot(u(0), u(1));
  }

 private:
  Batch<double> x_;
};

}  // namespace physinv::scaling
