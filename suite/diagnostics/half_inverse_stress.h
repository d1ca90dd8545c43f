/// How far half-inverse updates can be trusted: every combination of physics,
/// truncation, exponent, weights, batch and precision takes a few updates of
/// network and solver together, and is asked how it ended.
///
/// With J = U diag(s) V^T of the batch and g = dLoss/dy stacked, an update
/// that keeps s_i > cut = tau s_max obeys, for kappa < 0,
///
///   |update| <= s_smallest_kept^kappa |g| <= cut^kappa |g|
///
/// A batch holds different samples or each of them twice: then J has half as
/// many singular values, sqrt(2) as large, and exact zeros. Nothing is ever
/// NaN: what has no number is -1 and has a status.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "suite/diagnostics/diagnostic.h"

namespace physinv {

enum class StressStatus : std::uint8_t {
  ok,
  zero,       ///< g = 0 or nothing kept: an update was exactly 0
  unproven,   ///< an update whose accuracy was not shown
  nonfinite,  ///< an update or a loss is not finite
};
inline constexpr std::array<std::string_view, 4> kStressStatusNames = {
    "ok", "zero", "unproven", "nonfinite"};

/// Weights as drawn, times `gain`; `blind` physics has a Jacobian of zeros.
struct StressStart {
  std::string name;
  double gain = 1;
  bool blind = false;

  auto fields() const {
    return std::tuple{
        field("name", name), field("gain", gain), field("blind", blind)};
  }
};

struct HalfInverseStressOptions {
  std::string name = "stress";  ///< of the stage
  std::vector<ProblemRecipe> problems;
  std::vector<double> taus, kappas;
  std::vector<StressStart> starts;
  std::vector<Index> samples;  ///< different ones of a batch
  Index updates = 3;
  double rate = 1;

  auto fields() const {
    return std::tuple{word("problems", fingerprint(problems), problems),
                      field("taus", taus),
                      field("kappas", kappas),
                      field("starts", starts),
                      field("samples", samples),
                      field("updates", updates),
                      field("rate", rate),
                      implied(name)};
  }
};

/// Axes of the cells, the first varying fastest.
enum class StressAxis : std::uint8_t {
  problem,
  tau,
  kappa,
  start,
  samples,
  copies,     ///< 0: each sample once, 1: twice
  precision,  ///< 0: float, 1: double
};
inline constexpr Index kStressAxes = 7;

/// Arrays, one column per cell: `cell` (position on each axis), `status`,
/// `loss` (mean before the first and after the last update), `size` (largest
/// |update| over the two bounds above; the second -1 without a cut), `norm`
/// (largest |update|), `kept` and `path` (hig::Path) of the first update,
/// `rows` (m).
std::shared_ptr<const Stage> half_inverse_stress(
    HalfInverseStressOptions options);

}  // namespace physinv
