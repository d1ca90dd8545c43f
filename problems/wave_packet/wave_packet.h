/// Wave packet localization: where in a noisy signal is the packet? (Joint
/// parameter optimization, Sec. 4, Fig. 3, App. D.1.)
///
///   u(t; t0) = A cos(w d + p) exp(-d^2 / (2 s^2)),  d = t - t0,
///   t = 1 .. samples,  t0 = centre + scale xi,  y = u + eps
///   du/dt0 = (w sin(w d + p) + cos(w d + p) d / s^2) A exp(-d^2 / (2 s^2))
///
/// Unknown x: xi (1). Given: an additive disturbance eps. Observation y: the
/// signal. `sample` hides its noise (given = 0), so that the loss of the truth
/// is the noise's and cannot become 0; `sample_labelled` shows it. Both draw
/// the same signals from the same stream.
///
/// xi is not bounded. A packet far from every sample is exactly 0: in double
/// where exp underflows (38.6 s), in float where the envelope is below 1e-17
/// (8.85 s). Such an xi has no gradient, and exactly the loss of no packet; in
/// double every xi has that loss once the packet no longer changes a bit of the
/// target. Samples that are not computed are counted as `skipped_zeros`.
///
/// vjp, Jacobian: exact. Errors below 1e-13 A in double, 1e-6 A in float. An
/// xi that is not finite gives NaN in its own column only.
#pragma once

#include <array>
#include <vector>

#include "suite/core/problem.h"
#include "suite/core/recipe.h"

namespace physinv {

struct WavePacketOptions {
  Index samples = 256;     ///< length of the signal, a multiple of 64
  double amplitude = 1.0;  ///< A
  double frequency = 1.0;  ///< w, radians per sample
  double phase = 0.0;      ///< p; -pi / 2 makes a sine of the cosine
  double width = 20.0;     ///< s, samples, at least 1
  double centre = 128.0;   ///< t0 at xi = 0
  double scale = 128.0;    ///< samples per unit of xi
  double noise = 0.1;      ///< standard deviation of eps
  std::array<double, 2> range = {26.0, 230.0};  ///< of the true t0, uniform
  bool half_loss = true;  ///< half the squared error, or all of it

  auto fields() const {
    return std::tuple{field("samples", samples),
                      field("amplitude", amplitude),
                      field("frequency", frequency),
                      field("phase", phase),
                      field("width", width),
                      field("centre", centre),
                      field("scale", scale),
                      field("noise", noise),
                      field("range", range),
                      field("half_loss", half_loss)};
  }
};

template <class T>
class WavePacket : public Problem<T>, public Vjp<T>, public Jacobian<T> {
 public:
  using Options = WavePacketOptions;
  explicit WavePacket(const Options& options = {});

  Shape shape() const override {
    return {1, options_.samples, options_.samples};
  }
  Vector<double> start() const override { return Vector<double>::Zero(1); }

  /// x is the true xi, given is 0.
  Samples<double> sample(Index first,
                         Index count,
                         const Rng& rng) const override;
  /// The same signals with their noise as given.
  Samples<double> sample_labelled(Index first,
                                  Index count,
                                  const Rng& rng) const override;

  void forward(BatchIn<T> x,
               BatchIn<T> given,
               BatchOut<T> y,
               Workspace& work) const override;
  /// Keeps du/dt0 and where it is not 0.
  void linearize(BatchIn<T> x,
                 BatchIn<T> given,
                 BatchOut<T> y,
                 Tape& tape) const override;
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override;
  void jacobian(BatchIn<T> x,
                BatchIn<T> given,
                BatchOut<T> j,
                Workspace& work) const override;

  /// Squared error or half of it, in lanes of double added up in a fixed order:
  /// signals with the same bits have the same loss, whoever computed them.
  void loss(BatchIn<T> y,
            BatchIn<T> target,
            VectorOut<double> loss) const override;
  void loss_gradient(BatchIn<T> y,
                     BatchIn<T> target,
                     BatchOut<T> y_bar) const override;

  /// Six per sample, and four transcendental functions of 20 each.
  double operations() const override {
    return 6 * static_cast<double>(options_.samples) + 80;
  }

  const Options& options() const { return options_; }

 private:
  /// cos(w m) and sin(w m) times exp(-m^2 / (2 s^2)) at integers m, 0 beyond
  /// the reach, with a block of zeros on either side.
  struct Tables {
    std::vector<T> cosine, sine;
    Index reach = 0;  ///< largest |m| that counts
  };
  /// Samples first .. last - 1 of a signal.
  struct Span {
    Index first, last;
  };

  template <bool kSlope>
  Span packet(T xi, const T* given, T* y, T* slope) const;
  template <bool kSlope>
  void draw(double t0, Span span, const T* given, T* y, T* slope) const;

  Options options_;
  Tables tables_;
};

extern template class WavePacket<float>;
extern template class WavePacket<double>;

}  // namespace physinv
