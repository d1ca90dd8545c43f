/// How far a problem can be trusted: at each of many points, does the forward
/// pass stay finite in double and in float, and is the adjoint its derivative?
///
/// With w and v fixed unit vectors, every point gets five checks:
///   forward f64      is y finite?
///   forward f32      |y_32 - y_64| <= 1e-3 |y_64|
///   adjoint          (J^T w) . v against central differences of w . F(x + hv)
///   tangent          the same against w . (J v), if there is a Jacobian
///   adjoint f32      |J^T w in float - in double| <= 1e-2 |J^T w|
/// Differences take h = 0.1 / 4^k, extrapolated (Richardson) from neighbouring
/// steps; the value that differs least from both neighbours counts, the
/// difference is its uncertainty. Where that disagrees, a point next to an edge
/// may look smooth from afar: h = 1e-7 / 4^k decides if it can. Discrepancies
/// are relative to |J^T w|. Nothing is ever NaN: what has no number has a
/// status.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "suite/diagnostics/diagnostic.h"

namespace physinv {

enum class SweepStatus : std::uint8_t {
  ok,
  inaccurate,  ///< finite, but beyond the tolerance
  diverged,    ///< not finite
  undecided,   ///< nothing to compare with: no Jacobian, or no step works
};

enum class SweepCheck : std::uint8_t {
  forward_double,
  forward_single,
  adjoint,
  tangent,
  adjoint_single,
};

inline constexpr Index kSweepChecks = 5;
inline constexpr std::array<std::string_view, kSweepChecks> kSweepCheckNames = {
    "forward f64",
    "forward f32",
    "adjoint, differences",
    "adjoint, tangent",
    "adjoint f32"};
inline constexpr std::array<std::string_view, 4> kSweepStatusNames = {
    "ok", "inaccurate", "diverged", "undecided"};

struct SweepPoint {
  SweepPoint(Index of, const Vector<double>& at)
      : SweepPoint(of, [at] { return at; }) {}
  SweepPoint(Index of, std::function<Vector<double>()> at)
      : problem(of), x(std::move(at)) {}

  Index problem;                      ///< in the list of problems
  std::function<Vector<double>()> x;  ///< made when it is looked at
};

inline constexpr Index kSweepRows = 1000;

/// Their number and the hash of all.
std::string fingerprint(const std::vector<SweepPoint>& points);

struct StabilitySweepOptions {
  std::string name = "stability";  ///< of the stage
  std::vector<ProblemRecipe> problems;
  std::vector<SweepPoint> points;  ///< those of one problem side by side
  /// Gradients smaller than this count as that large: rounding, underflow and
  /// cut-off tails have no relative accuracy.
  double zero = 1e-30;
  Index examples = 1;  ///< side inputs drawn per point, if the problem has any

  auto fields() const {
    return std::tuple{word("problems", fingerprint(problems), problems),
                      word("points", fingerprint(points), points),
                      field("zero", zero),
                      field("examples", examples),
                      implied(name)};
  }
};

/// Arrays, one column per point, in their order, examples side by side:
/// `point` (x, of its first kSweepRows; 0 below a shorter one), `status` and
/// `error` (kSweepChecks rows; -1: no number).
std::shared_ptr<const Stage> stability_sweep(StabilitySweepOptions options);

/// A derivative from central differences d(k) with steps h0 / 4^k.
struct Extrapolated {
  double value = 0, uncertainty = 0;
  bool found = false;  ///< false without four neighbouring finite differences
};
Extrapolated extrapolate(VectorIn<double> differences);

}  // namespace physinv
