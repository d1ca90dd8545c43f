/// The combinations that half-inverse updates are asked for, and the cells of
/// a finished sweep over them.
#pragma once

#include <vector>

#include "suite/core/whole.h"
#include "suite/diagnostics/half_inverse_stress.h"
#include "suite/store/record.h"

namespace physinv::half_inverse_numerics {

inline constexpr const char* kName = "numerics/half-inverse";
inline constexpr const char* kMethod = "stability";
inline constexpr const char* kStage = "stress";

inline const std::vector<double> kGammas = {1, 1e-2, 1e-4, 1e-6, 1e-9, 1e-12};
inline const std::vector<double> kTaus = {0, 1e-10, 1e-6, 1e-4, 1e-2};
inline const std::vector<double> kKappas = {-0.5, -1};
inline const std::vector<StressStart> kStarts = {{"as drawn", 1},
                                                 {"x 10", 10},
                                                 {"x 1000", 1e3},
                                                 {"all zero", 0},
                                                 {"J = 0", 1, true}};
/// Two observations each, 30 parameters: more columns than rows, and fewer.
inline const std::vector<Index> kSamples = {4, 20};

/// The stage's cells by their position on the axes.
class Cells {
 public:
  explicit Cells(const StageRecord& stage) : arrays_(stage.arrays) {}

  Index count() const { return arrays_.at("status").cols(); }
  Index on(StressAxis axis, Index cell) const {
    return whole_part<Index>(
        arrays_.at("cell")(static_cast<Index>(axis), cell));
  }
  double get(ArrayKey array, Index cell, Index row = 0) const {
    return arrays_.at(array)(row, cell);
  }
  StressStatus status(Index cell) const {
    return static_cast<StressStatus>(whole_part<int>(get("status", cell)));
  }
  bool is(StressStatus s, Index cell) const { return status(cell) == s; }
  double tau(Index cell) const {
    return kTaus[static_cast<std::size_t>(on(StressAxis::tau, cell))];
  }
  /// Physics with a Jacobian of zeros.
  bool blind(Index cell) const {
    return kStarts[static_cast<std::size_t>(on(StressAxis::start, cell))].blind;
  }
  /// The same combination with each sample once.
  Index once(Index cell) const {
    const auto axis = static_cast<Index>(StressAxis::copies);
    Batch<double> wanted = arrays_.at("cell").col(cell);
    wanted(axis) = 0;
    Index at = cell;
    while (arrays_.at("cell").col(at) != wanted) --at;
    return at;
  }

 private:
  const Arrays& arrays_;
};

}  // namespace physinv::half_inverse_numerics
