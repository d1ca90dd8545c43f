/// What one step of gradient descent on a network's weights does to its
/// outputs (JPO paper, Sec. 3, Eq. 3 without clipping and averaging):
///
///   theta' = theta - rate / scale^2  sum_j g_j dx_j / dtheta
///   delta_i = x(gamma_i; theta') - x(gamma_i; theta)
///
/// for many small networks x(gamma) = scale N(gamma; theta) of one input and
/// one output, each with its own weights and examples: network k lives in lane
/// k. The second forward pass is the paper's; no linearisation.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "suite/core/recipe.h"
#include "suite/core/rng_lanes.h"
#include "suite/core/simd/pack.h"

namespace physinv {

enum class TinyActivation : std::uint8_t { tanh, relu };

constexpr std::string_view to_string(TinyActivation a) {
  return a == TinyActivation::relu ? "relu" : "tanh";
}

struct TinyNetOptions {
  std::vector<Index> hidden = {64};
  TinyActivation activation = TinyActivation::relu;
  double scale = 1;    ///< of the output
  double rate = 1e-3;  ///< of the step, divided by scale^2
  /// |gamma| is at most this. More examples of a tanh network than `nodes`
  /// are seen through polynomials, see `one_step`.
  double range = 2;
  bool nodes = true;  ///< false: a pass per example, however many

  auto fields() const {
    return std::tuple{word("network", layers(), hidden, activation),
                      field("scale", scale),
                      field("rate", rate),
                      field("range", range),
                      field("nodes", nodes)};
  }
  /// "1-64-1 relu"
  std::string layers() const;
};

template <class T>
class OneStep {
 public:
  using P = Pack<T>;

  virtual ~OneStep() = default;

  /// Per layer its weights [out][in], then its biases.
  virtual std::span<P> parameters() = 0;
  /// Fan-in of the layer of every parameter.
  virtual std::vector<Index> fan_in() const = 0;

  /// x of n examples; remembers them for `respond`.
  virtual void predict(const P* gamma, Index n, P* x) = 0;
  /// delta for the gradients g of the last examples.
  virtual void respond(const P* g, P* delta) = 0;

  /// Network passes that n examples take, one way.
  virtual Index passes(Index n) const = 0;

  /// Weights and biases uniform in +-1/sqrt(fan_in).
  void initialize(StreamLanes<T>& random);

 private:
  std::vector<T> bounds_;
};

/// One hidden layer of ReLU: sums over active units only, no matrices.
///
/// Deep tanh networks: matrices of lanes. x(gamma) and dx/dtheta(gamma) are
/// analytic, so for many examples both are Chebyshev polynomials through a few
/// nodes, exact to rounding: sum_j g_j dx_j/dtheta is the sum over nodes with
/// weights c_m = sum_j g_j l_m(gamma_j), l_m the Lagrange polynomials.
template <class T>
std::unique_ptr<OneStep<T>> one_step(const TinyNetOptions& options);

extern template class OneStep<float>;
extern template class OneStep<double>;

}  // namespace physinv
