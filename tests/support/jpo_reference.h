/// Entries `jpo_mlp` and `jpo_g2s` of the reference files through the stage
/// itself: a network and a problem that write down what passes through them.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "suite/core/method.h"
#include "suite/core/problem.h"
#include "suite/core/recipe.h"
#include "tests/support/reference.h"

namespace physinv::test {

/// What one run passed around; the first pass of each is the warm-up.
struct Notes {
  std::vector<Batch<double>> outputs, clipped, xi, gradients;
  std::vector<Vector<double>> weights;
};
extern Notes* notes;

/// What the specification says about the network and its training; an entry
/// may state other rates and factors.
struct JpoEntry {
  std::vector<Field> inputs;
  NetworkRecipe network;
  double rate;
  double last_matrix = 1;   ///< factor of its formula weights
  double output_scale = 1;  ///< estimates = start + scale * output
  /// In float, relative to the largest entry (M9 of the methods).
  struct {
    double output = 1e-4, loss = 1e-4, gradient = 1e-4;
  } single = {};
};

/// The stage on a problem with these samples, against every step of the entry;
/// in float, against the first.
void expect_jpo(const std::string& id,
                const Json& entry,
                JpoEntry about,
                const ProblemRecipe& problem,
                Samples<double> samples,
                Precision precision);

}  // namespace physinv::test
