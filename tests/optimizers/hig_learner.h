/// Network and solver of the half-inverse-gradient reference files: both at
/// one batch and given weights, and the checks that several files need.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "optimizers/half_inverse/half_inverse_step.h"
#include "suite/core/problem.h"
#include "suite/nn/cnn.h"
#include "tests/support/hig_reference.h"

namespace physinv::test {

/// A network whose flat vectors are the files': weights [tap][in][out].
class Ordered {
 public:
  Ordered(const std::vector<Index>& sizes, nn::Activation activation);
  Ordered(const nn::CnnOptions& options, Index outputs);

  Vector<double> ours(const Vector<double>& theirs) const {
    return permuted(theirs, false);
  }
  Vector<double> theirs(const Vector<double>& ours) const {
    return permuted(ours, true);
  }
  /// The start that an entry's input describes, in the files' order:
  /// theta_k = limit (2 hash(k + offset) - 1), limit of Glorot times gain.
  Vector<double> start(const Json& in) const;

  std::unique_ptr<Network<double>> net;
  std::unique_ptr<Network<float>> single;

 private:
  struct Layer {
    Index taps, in, out;
  };

  Vector<double> permuted(const Vector<double>& from, bool back) const;

  std::vector<Layer> layers_;
};

/// One experiment of the files.
struct Learner {
  std::unique_ptr<Problem<double>> problem;
  std::unique_ptr<Problem<float>> single;
  Ordered network;
  /// g = factor(b) dl/dy
  std::function<double(Index)> factor;
  bool given_is_target = false, input_is_given = false;
  /// An update in float against the file's, relative in the 2-norm.
  double in_float = 1e-4;
};

/// Everything at one set of weights for one batch of observations.
struct At {
  At(const Learner& learner,
     const Vector<double>& theirs,
     const Batch<double>& target,
     const Batch<double>& given);
  /// With what the learner is given of its target: all or nothing.
  At(const Learner& learner,
     const Vector<double>& theirs,
     const Batch<double>& target);

  Vector<double> gradient();
  /// Takes the update off theta.
  Vector<double> update(HalfInverseStep<double>& step);
  /// The same by network, solver and step in float.
  Vector<double> update_in_float(const HalfInverseStepOptions& options) const;
  /// Row by row from backward passes, unlike every path of the library.
  Batch<double> stacked_jacobian();

  const Learner& learner;
  Vector<double> theta, loss;
  Batch<double> in, given, target, x, y, g, mean_gradient, jacobian;
  Tape tape;
  Workspace work;
};

/// One column per sample, whatever its shape.
Batch<double> flat_columns(const Json& list);

/// delta_k-0.5_tau1e-05_beta0, the last part optional.
bool parse_power(const std::string& key, hig::Power& power);

/// Estimates, loss, gradient, singular values and updates of an entry, in
/// double; `targets` is its input's name.
void check_batch(const Learner& l, const char* targets, const Json& entry);

/// Consecutive minibatches in fixed order, by the strictest path and, as far as
/// the entry allows updates to differ, by the library's own.
void check_sequence(const Learner& l,
                    const char* targets,
                    Index batch,
                    const Json& entry);

}  // namespace physinv::test
