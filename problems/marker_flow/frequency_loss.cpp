#include "problems/marker_flow/frequency_loss.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "suite/core/check.h"
#include "suite/core/math.h"

namespace physinv {
namespace {

/// to += c from, written out: the bits must not depend on the compiler.
void add_times(double c, const double* from, double* to, Index count) {
  for (Index i = 0; i < count; ++i) to[i] = std::fma(c, from[i], to[i]);
}

}  // namespace

FrequencyLoss::FrequencyLoss(Index cells, double falloff, double threshold)
    : cells_(cells),
      exponent_(-0.5 * falloff * falloff / double(cells * cells)),
      least_(std::sqrt(threshold)),
      cosine_(static_cast<std::size_t>(cells)),
      sine_(cosine_) {
  SUITE_CHECK(falloff >= 0 && threshold > 0,
              "falloff must not be negative, threshold must be positive");
  for (std::size_t j = 0; j < cosine_.size(); ++j) {
    const double turn = double(j) / double(cells);
    cosine_[j] = math::cos(2 * std::numbers::pi * turn);
    sine_[j] = math::sin(2 * std::numbers::pi * turn);
  }
}

double FrequencyLoss::weight(Index k, Index l) const {
  return math::exp(exponent_ * double(k * k + l * l));
}

double FrequencyLoss::floor() const { return double(cells_ * cells_) * least_; }

double FrequencyLoss::operator()(VectorIn<double> difference,
                                 double* gradient) const {
  const Index n = cells_, half = n / 2;
  check_size(difference, n * n, 1);
  double total = 0, most = 0;
  for (const double d : difference) total += d;
  const double mean = total / double(n * n);
  const Vector<double> d = difference.array() - mean;
  for (const double v : d) most += std::abs(v);
  if (!std::isfinite(most)) {
    constexpr double kLost = std::numeric_limits<double>::quiet_NaN();
    if (gradient != nullptr) std::fill_n(gradient, n * n, kLost);
    return kLost;
  }
  Index reach = 0;
  while (reach < half && weight(reach + 1, 0) * most > least_) ++reach;

  // Over i for k = 0 .. reach, the others being conjugates; then over j.
  const auto turn = [n](Index a, Index b) {
    return static_cast<std::size_t>((a * b % n + n) % n);
  };
  double loss = 0;
  Vector<double> out = Vector<double>::Zero(gradient != nullptr ? n * n : 0);
  Vector<double> re(n), im(n);
  for (Index k = 0; k <= reach; ++k) {
    re.setZero(), im.setZero();
    for (Index i = 0; i < n; ++i) {
      add_times(cosine_[turn(k, i)], d.data() + i * n, re.data(), n);
      add_times(-sine_[turn(k, i)], d.data() + i * n, im.data(), n);
    }
    const double twice = k > 0 && 2 * k < n ? 2 : 1;
    Vector<double> g_re = Vector<double>::Zero(n), g_im = g_re;
    // Half a turn per cell is there once.
    for (Index l = 2 * reach < n ? -reach : 1 - reach; l <= reach; ++l) {
      const double w = weight(k, l);
      if ((k == 0 && l == 0) || w * most <= least_) continue;
      double a = 0, b = 0;
      for (Index j = 0; j < n; ++j) {
        const double c = cosine_[turn(l, j)], s = sine_[turn(l, j)];
        a = std::fma(im(j), s, std::fma(re(j), c, a));
        b = std::fma(-re(j), s, std::fma(im(j), c, b));
      }
      const double size = math::hypot(a, b);
      if (w * size <= least_) continue;
      loss += twice * (w * size - least_);
      const double g = twice * w / size;
      for (Index j = 0; j < n; ++j) {
        const double c = cosine_[turn(l, j)], s = sine_[turn(l, j)];
        g_re(j) = std::fma(g * a, c, std::fma(-g * b, s, g_re(j)));
        g_im(j) = std::fma(g * a, s, std::fma(g * b, c, g_im(j)));
      }
    }
    for (Index i = 0; i < n && gradient != nullptr; ++i) {
      add_times(cosine_[turn(k, i)], g_re.data(), out.data() + i * n, n);
      add_times(-sine_[turn(k, i)], g_im.data(), out.data() + i * n, n);
    }
  }
  std::copy_n(out.data(), out.size(), gradient);
  return loss;
}

}  // namespace physinv
