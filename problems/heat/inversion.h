/// The local inverse of heat again and again: x <- x + dx(x), from zero.
///
/// `invert` goes to the cells and back four times per step. Here x and y
/// stay spectra; only |dy|, from which the uncertainty is summed up, is asked
/// of the cells, one transform per step. Modes with e^-s below 1e-30, a third,
/// are left alone: what is not below rounding there is noise, which is damped
/// once more. The same but for rounding.
#pragma once

#include <array>
#include <vector>

#include "problems/heat/heat.h"
#include "suite/core/workspace.h"

namespace physinv {

class HeatInversion {
 public:
  /// y: observations, one per column. Refers to `heat`.
  HeatInversion(const HeatModes& heat, BatchIn<double> y, Workspace& work);

  /// Counts as `invert` does.
  void step(Workspace& work);
  void estimate(BatchOut<double> x, Workspace& work);

 private:
  struct Place {
    Index p, q;
    std::array<Index, 4> at;  ///< in a spectrum
  };

  std::vector<Place> places() const;
  /// f(block, fields, spectra of y, of x), for all samples.
  template <class F>
  void for_spectra(Workspace& work, F&& f);
  template <class Fields, class F>
  void to_cells(Fields f, F&& value) const;

  const HeatModes& heat_;
  PlaneFft fft_;
  Index samples_;
  std::vector<Place> places_;
  Workspace kept_;
  Scratch<double> y_, x_;  ///< four numbers per place, a register per column
};

}  // namespace physinv
