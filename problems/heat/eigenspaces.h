/// Eigenspaces of the diffusion: waves of one |k|, and how much of an
/// observation each of them has. Methods of gradients stay, in exact
/// arithmetic, in the span of these parts, so that an unknown per eigenspace
/// stands for all cells.
#pragma once

#include <vector>

#include "problems/heat/heat.h"

namespace physinv {

class HeatEigenspaces {
 public:
  /// Those damped by more than e^-`most` are left out.
  HeatEigenspaces(const HeatModes& heat, double most);

  Index count() const { return static_cast<Index>(damping_.size()); }
  /// e^-s of each.
  Eigen::Map<const Vector<double>> damping() const {
    return {damping_.data(), count()};
  }
  /// Length of y's part in each.
  Vector<double> lengths(VectorIn<double> y) const;
  /// A gain for every mode from one for each space.
  Batch<double> spread(const Vector<double>& gain) const;

 private:
  PlaneFft fft_;
  Batch<Index> number_;  ///< of the space of a mode, -1 for none
  std::vector<double> damping_;
};

}  // namespace physinv
