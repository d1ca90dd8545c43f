/// A physics inverse problem y = F(x | given): find x from y.
///
/// Every call takes batches (a single problem is a batch of one), is a pure
/// function of its arguments and leaves their sizes to its callers: AnyProblem,
/// CountedProblem, the oracle and Python check them. Abilities beyond the
/// forward pass are separate base classes; the base-class list is the
/// declaration, read by `provides`.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>

#include "suite/core/batch.h"
#include "suite/core/dataset.h"
#include "suite/core/rng.h"
#include "suite/core/workspace.h"

namespace physinv {

/// Rows of the batches.
struct Shape {
  Index unknowns = 0;      ///< x
  Index observations = 0;  ///< y
  Index given = 0;         ///< side input, may be 0
};

/// Where a problem is looked at, a column per sample.
template <class T>
struct Point {
  Eigen::Ref<const Batch<T>> x, given;
};

/// Along what a pullback changes: x moves along x_dot, y_bar along y_bar_dot.
template <class T>
struct Directions {
  Eigen::Ref<const Batch<T>> x_dot, y_bar, y_bar_dot;
};

/// One sample while it is drawn, in double: zeros to be written.
struct SampleOut {
  Index index;    ///< in its set
  Rng rng;        ///< its own, for streams after the first
  bool labelled;  ///< a pair (x, F(x)), not an inverse problem
  VectorOut<double> x, y, given;
};

/// What of an inverse problem `draw` writes in addition to `given`.
enum class Drawn : std::uint8_t {
  unknowns,      ///< x; y = F(x | given)
  both,          ///< y, and the x that explains it
  observations,  ///< y; no solution is known
};

template <class T>
class Problem {
 public:
  virtual ~Problem() = default;

  virtual Shape shape() const = 0;

  /// Where classical optimizers start, one point for all problems.
  virtual Vector<double> start() const = 0;

  /// Draws one sample, `stream` being the first of its own.
  virtual void draw(Stream& stream, SampleOut& sample) const = 0;
  /// Of labelled samples, always `unknowns`.
  virtual Drawn drawn() const { return Drawn::unknowns; }
  /// Takes out of the side input of an inverse problem what helped to make y
  /// and is not known.
  virtual void hide(BatchOut<double> /*given*/) const {}

  /// Inverse problems first .. first+count-1 of the set `rng` addresses; the
  /// i-th draws from rng.child(i), so small sets are prefixes of large ones.
  /// x holds the true solution where one is known (no rows otherwise). Of
  /// problems in double alone.
  Samples<double> sample(Index first, Index count, const Rng& rng) const {
    return draw_set(first, count, rng, false);
  }

  /// Pairs (x, y = F(x)) for methods that learn from labels.
  Samples<double> sample_labelled(Index first,
                                  Index count,
                                  const Rng& rng) const {
    return draw_set(first, count, rng, true);
  }

  /// y = F(x | given). A diverging sample fills its column with non-finite
  /// values and disturbs no other.
  virtual void forward(Point<T> at, BatchOut<T> y, Workspace& work) const = 0;

  /// Loss per sample, half squared error unless the paper has another, summed
  /// in double.
  virtual void loss(BatchIn<T> y,
                    BatchIn<T> target,
                    VectorOut<double> loss) const {
    for (Index i = 0; i < y.cols(); ++i) {
      double sum = 0;
      for (Index j = 0; j < y.rows(); ++j) {
        const double r = static_cast<double>(y(j, i) - target(j, i));
        sum = std::fma(r, r, sum);
      }
      loss(i) = 0.5 * sum;
    }
  }

  /// d loss / d y per sample.
  virtual void loss_gradient(BatchIn<T> y,
                             BatchIn<T> target,
                             BatchOut<T> y_bar) const {
    for_numbers<T>(y, target, y_bar, [](T a, T b) { return a - b; });
  }

  /// Samples whose gradients are best computed together, so that what
  /// `linearize` keeps is still in the cache for `pullback`. 0: any number.
  virtual Index gradient_block() const { return 0; }

  /// Rough floating-point operations of one forward pass of one sample.
  virtual double operations() const = 0;

 private:
  Samples<double> draw_set(Index first,
                           Index count,
                           const Rng& rng,
                           bool labelled) const;
};

template <>
Samples<double> Problem<float>::draw_set(Index, Index, const Rng&, bool) const;
template <>
Samples<double> Problem<double>::draw_set(Index, Index, const Rng&, bool) const;

/// Exact derivative of the discrete forward, in reverse.
template <class T>
class Vjp {
 public:
  virtual ~Vjp() = default;
  /// Forward pass that remembers what `pullback` needs.
  virtual void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const = 0;
  /// x_bar = J^T y_bar at the point of the last `linearize` on this tape.
  virtual void pullback(const Tape& tape,
                        BatchIn<T> y_bar,
                        BatchOut<T> x_bar,
                        Workspace& work) const = 0;
};

/// The same derivative forward, at the point of `Vjp::linearize`. Such a
/// problem's loss is half the squared error: its own second derivative by y is
/// the identity.
template <class T>
class Jvp {
 public:
  virtual ~Jvp() = default;
  /// y_dot = J x_dot at the point of the last `linearize` on this tape.
  virtual void pushforward(const Tape& tape,
                           BatchIn<T> x_dot,
                           BatchOut<T> y_dot,
                           Workspace& work) const = 0;
};

/// What products with the Hessian of a loss need in addition to both
/// derivatives.
template <class T>
class PullbackTangent {
 public:
  virtual ~PullbackTangent() = default;
  /// x_bar_dot = J^T y_bar_dot + (dJ/dx x_dot)^T y_bar: the derivative of
  /// `Vjp::pullback` where x moves along x_dot and y_bar along y_bar_dot, at
  /// the point of the last `linearize` on this tape.
  virtual void pullback_tangent(const Tape& tape,
                                Directions<T> along,
                                BatchOut<T> x_bar_dot,
                                Workspace& work) const = 0;
};

/// Full Jacobians: column i holds sample i's observations x unknowns matrix,
/// column-major.
template <class T>
class Jacobian {
 public:
  virtual ~Jacobian() = default;
  virtual void jacobian(Point<T> at, BatchOut<T> j, Workspace& work) const = 0;
};

/// Local inverse near a guess: `near.x` is the guess.
template <class T>
class Inverse {
 public:
  virtual ~Inverse() = default;
  virtual void invert(Point<T> near,
                      BatchIn<T> y,
                      BatchOut<T> x,
                      Workspace& work) const = 0;
};

/// Second derivative of the loss: column i holds sample i's matrix.
template <class T>
class Hessian {
 public:
  virtual ~Hessian() = default;
  virtual void hessian(Point<T> at,
                       BatchIn<T> target,
                       BatchOut<T> h,
                       Workspace& work) const = 0;
};

/// What a method needs and a problem provides, as a set of bits.
enum class Needs : std::uint8_t {
  forward = 1,
  vjp = 2,
  jacobian = 4,
  inverse = 8,
  hessian = 16,
  labels = 32,
  jvp = 64,
  pullback_tangent = 128,
};

constexpr Needs operator|(Needs a, Needs b) {
  return static_cast<Needs>(static_cast<unsigned>(a) |
                            static_cast<unsigned>(b));
}
constexpr bool contains(Needs all, Needs some) {
  return (static_cast<unsigned>(all) & static_cast<unsigned>(some)) ==
         static_cast<unsigned>(some);
}

/// Reads the base-class list of P = SomeProblem<T>. Every problem can draw
/// labelled samples.
template <class P, class T>
constexpr Needs provides() {
  Needs all = Needs::forward | Needs::labels;
  if constexpr (std::derived_from<P, Vjp<T>>) all = all | Needs::vjp;
  if constexpr (std::derived_from<P, Jacobian<T>>) all = all | Needs::jacobian;
  if constexpr (std::derived_from<P, Inverse<T>>) all = all | Needs::inverse;
  if constexpr (std::derived_from<P, Hessian<T>>) all = all | Needs::hessian;
  if constexpr (std::derived_from<P, Jvp<T>>) all = all | Needs::jvp;
  if constexpr (std::derived_from<P, PullbackTangent<T>>)
    all = all | Needs::pullback_tangent;
  return all;
}

}  // namespace physinv
