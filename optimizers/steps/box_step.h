/// Where L-BFGS-B aims: first the generalized Cauchy point, the first local
/// minimiser of the quadratic model along the path x - t g bent by the bounds,
/// then the minimiser in the subspace of the unknowns that are free there,
/// brought back into the bounds as of lbfgsb.f 3.0 (Morales, Nocedal 2011).
#pragma once

#include <vector>

#include "optimizers/steps/limited_memory.h"

namespace physinv {

/// Bounds of each unknown; infinite where there is none.
struct Box {
  Vector<double> lower, upper;

  bool bounds_any() const;
  bool bounds_all() const;
  double project(Index i, double value) const;
  /// Largest entry of x - project(x - g).
  double gradient_norm(const double* x, const double* g) const;
  /// Largest t <= longest with x + t d inside.
  double longest_step(const double* x, const double* d, double longest) const;
};

class BoxStep {
 public:
  /// `box` must outlive the object; m is the memories' size.
  void start(const Box& box, Index m);

  /// The target z for x inside the box, gradient g. False if rounding has
  /// spoilt the memory.
  bool aim(const double* x, const double* g, LimitedMemory& memory, double* z);

 private:
  struct Break {
    double t;
    Index unknown;
  };

  void cauchy_point(const double* x,
                    const double* g,
                    const LimitedMemory& memory,
                    double* z);
  void start_path(const double* x, const double* g);
  bool subspace_minimum(const double* x,
                        const double* g,
                        LimitedMemory& memory,
                        double* z);
  void back_into_box(const double* x, const double* g, double* z);

  const Box* box_ = nullptr;
  bool bounded_ = false, path_ends_ = false;
  std::vector<char> free_;        // unknowns not at a bound in the Cauchy point
  std::vector<Break> breaks_;     // where the path meets bounds
  Vector<double> path_;           // its direction
  Vector<double> newton_;         // step of the subspace, zero where held
  Vector<double> p_, c_, w_, v_;  // W' path, W'(z - x), a row of W, M times
};

}  // namespace physinv
