/// The chapter's steps of Scaling towards y* = 0 for many problems at once, a
/// structure of arrays: each trajectory stays in registers for all its steps.
///
/// Steps are the reduced forms; x1 and x2 never meet. All are x *= 1 - rate,
/// but x2 of
///
///   gradient           power 1: x2 *= 1 - c rate alpha^2   (x1: 1 - c rate)
///                      power 2: x2 -= 2 c rate alpha^2 x2^3
///   newton             power 2: x2 *= 1 - rate / 3
///   inverse_gradient   power 2: x2 *= 1 - rate / 2
///   inverse_simulator  power 2: x2 *= sqrt(1 - rate), 0 if there is no root
///
/// with c = 1 for half the square and 2 for the square. A trajectory's bits
/// depend neither on the others nor on the threads.
#pragma once

#include "suite/core/batch.h"
#include "suite/core/options.h"
#include "suite/core/threads.h"

namespace physinv {

enum class ScalingStep : std::uint8_t {
  gradient,
  newton,
  inverse_gradient,
  inverse_simulator
};

constexpr std::string_view to_string(ScalingStep step) {
  constexpr std::string_view kNames[] = {
      "gradient", "newton", "inverse_gradient", "inverse_simulator"};
  return kNames[static_cast<std::size_t>(step)];
}

struct ScalingFlow {
  ScalingStep step = ScalingStep::gradient;
  int power = 1;
  double rate = 0.03;
  Index steps = 50;
  bool half = false;

  auto fields() const {
    return std::tuple{field("power", power),
                      field("rate", rate),
                      field("steps", steps),
                      field("flow", step),
                      if_changed(field("half", half))};
  }
};

/// Where every trajectory is after all steps; x1 and x2 may be the starts.
template <class T>
void advance(const ScalingFlow& flow,
             VectorIn<T> alpha,
             VectorIn<T> start1,
             VectorIn<T> start2,
             VectorOut<T> x1,
             VectorOut<T> x2,
             Threads* threads = nullptr);

}  // namespace physinv
