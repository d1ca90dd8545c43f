/// Strong diffusion on a periodic square: which field was it once?
/// (Scale-invariant physics training, App. B.3, Figs. 10 to 13; the data and
/// the constants of the inverse are those of the authors' code.)
///
///   y = F^-1 (e^-s F x),   s(k, l) = (2 pi / n)^2 (k^2 + l^2) end_time
///
/// Unknown x: n x n cells, row by row. Given: nothing. Observation y: as many.
/// Loss: half the squared error. vjp: exact, the operator is its own adjoint.
/// Ill-posed: s goes up to 158, so that the finest modes are damped by 1e-69
/// and what double precision says of them is noise.
///
/// invert: x + dx, dx = F^-1 (e^{s w} F dy) with dy = y - P(x) and a weight w
/// in [-1, 1] per mode, which follows from how its amplitude |Z| compares with
/// what a mode of this damping could show (n e^-s) and with what rounding may
/// have left (`HeatMode`). Modes that hold noise are damped once more, not
/// amplified.
///
/// x ("hot rectangles"): 4 to 10 rectangles of random place, size and strength
/// that add up; y = P(x), without noise. The mean of x is that of y.
///
/// Everything is computed in double, a register of fields at a time; single
/// precision is for inputs and outputs. A column that is not finite gives NaN
/// in its own column only.
#pragma once

#include <array>

#include "problems/heat/plane_fft.h"
#include "suite/core/recipe.h"

namespace physinv {

struct HeatOptions {
  Index resolution = 64;   ///< n, cells per side: a power of two, at least 8
  double end_time = 8;     ///< diffusivity times time, in squared cells
  double noise_floor = 0;  ///< of every y, taken as uncertain by `invert`

  auto fields() const {
    return std::tuple{field("resolution", resolution),
                      field("end_time", end_time),
                      field("noise_floor", noise_floor)};
  }
};

struct HeatRectangle {
  std::array<double, 2> centre;     ///< (row, column), in cells
  std::array<double, 2> half_size;  ///< the centre is moved to keep it inside
  double strength;
};

/// Adds the rectangle to a field, n cells per side; edges are ramps half the
/// diagonal of a cell to either side.
void add_rectangle(HeatRectangle rectangle, Index n, double* field);

/// How the local inverse takes one mode of dy.
struct HeatMode {
  double probability;  ///< that it is signal: S / (S + N)
  double gain;         ///< e^{s w}

  /// S = exp(-(|Z| / expected)^2 / 2) / 2, or 0 where that is not a number, N
  /// the same with `uncertainty`; w = 2 p - 1, but 0 for p in (0.5, 0.68) and
  /// where p is not a number. In plain double: S and N both vanish for a |Z|
  /// beyond 38 times both scales, which must be damped (p = 0, w = -1).
  static HeatMode of(double amplitude,
                     double exponent,
                     double expected,
                     double uncertainty);
};

/// By position of the spectrum: s, n e^-s (what a mode could show), e^-s, e^s.
struct HeatTable {
  HeatTable(const HeatOptions& options, const PlaneFft& fft);
  Batch<double> s, expected, damping, amplification;
};

/// What `steps` steps of gradient descent (rate 1, from zero) make of y, mode
/// by mode: (1 - (1 - e^-2s)^steps) e^s, of `exponents` s.
Batch<double> heat_gradient_descent(const Batch<double>& exponents,
                                    Index steps);

/// The diffusion of each mode, for tests and plots of spectra.
class HeatModes {
 public:
  explicit HeatModes(const HeatOptions& options);

  const HeatOptions& options() const { return options_; }
  const PlaneFft& fft() const { return fft_; }
  const HeatTable& table() const { return table_; }
  /// s(k, l), k, l = 0 .. n/2.
  const Batch<double>& exponents() const { return exponents_; }
  /// out = F^-1 (gain F in); gain as `exponents`.
  template <class T>
  void filter(BatchIn<T> in,
              const Batch<double>& gain,
              BatchOut<T> out,
              Workspace& work) const;

 private:
  HeatOptions options_;
  PlaneFft fft_;
  HeatTable table_;
  Batch<double> exponents_;
};

/// Of a heat problem; null of any other.
const HeatOptions* heat_options(const Problem<double>& problem);

namespace problems {
ProblemRecipe heat(const HeatOptions& options = {});
}

}  // namespace physinv
