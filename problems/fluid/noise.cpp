#include "problems/fluid/noise.h"

#include <cmath>
#include <numbers>

#include "suite/core/check.h"
#include "suite/core/math.h"

namespace physinv::fluid {
namespace {

/// to += c from, written out: the bits must not depend on the compiler.
void add_times(double c, const double* from, double* to, Index count) {
  for (Index i = 0; i < count; ++i) to[i] = std::fma(c, from[i], to[i]);
}

/// Plain sums over the modes, one direction after the other: fields are few.
struct Transform {
  explicit Transform(Index size)
      : n(size), cosine(n, n), sine(n, n), re(n, n), im(n, n) {
    for (Index j = 0; j < n; ++j) {
      const double angle = 2 * std::numbers::pi * double(j) / double(n);
      cosine(j, 1) = math::cos(angle), sine(j, 1) = math::sin(angle);
    }
    for (Index k = 0; k < n; ++k)
      for (Index j = 0; j < n; ++j) {
        cosine(j, k) = cosine(j * k % n, 1), sine(j, k) = sine(j * k % n, 1);
      }
  }

  /// Real part of the unnormalised inverse transform; arrays by rows.
  void inverse_real(const double* a, const double* b, double* out) {
    re.setZero(), im.setZero();  // columns here are rows i, over ky
    for (Index i = 0; i < n; ++i)
      for (Index k = 0; k < n; ++k) {
        const double c = cosine(i, k), s = sine(i, k);
        add_times(c, a + k * n, re.col(i).data(), n);
        add_times(-s, b + k * n, re.col(i).data(), n);
        add_times(s, a + k * n, im.col(i).data(), n);
        add_times(c, b + k * n, im.col(i).data(), n);
      }
    std::fill_n(out, n * n, 0.0);
    for (Index i = 0; i < n; ++i)
      for (Index l = 0; l < n; ++l) {
        add_times(re(l, i), cosine.col(l).data(), out + i * n, n);
        add_times(-im(l, i), sine.col(l).data(), out + i * n, n);
      }
  }

  Index n;
  Batch<double> cosine, sine;  ///< of j k / n turns
  Batch<double> re, im;
};

void normalise(double deviation, Vector<double>& field) {
  const auto count = static_cast<double>(field.size());
  double sum = 0, squares = 0;
  for (const double f : field) sum += f;
  const double mean = sum / count;
  for (const double f : field) squares = std::fma(f - mean, f - mean, squares);
  const double scale = deviation / std::sqrt(squares / count);
  for (double& f : field) f = scale * (f - mean);
}

}  // namespace

Vector<double> smooth_noise(const NoiseOptions& o,
                            VectorIn<double> real,
                            VectorIn<double> imaginary) {
  const Index n = o.cells, plane = n * n;
  check_size(real, o.components * plane, 1);
  check_size(imaginary, o.components * plane, 1);
  Vector<double> field(o.components * plane), a(plane), b(plane);
  Transform transform(n);
  const auto wave = [n](Index k) { return k < n - k ? k : k - n; };
  for (Index c = 0; c < o.components; ++c) {
    for (Index m = 0; m < plane; ++m) {
      const Index x = wave(m / n), y = wave(m % n), square = x * x + y * y;
      const double weight = square > o.cut ? 1 / double(square) : 0;
      a(m) = weight * real(c * plane + m);
      b(m) = weight * imaginary(c * plane + m);
    }
    transform.inverse_real(a.data(), b.data(), field.data() + c * plane);
  }
  normalise(o.deviation, field);
  return field;
}

Vector<double> smooth_noise(const NoiseOptions& o, Stream& stream) {
  const Index modes = o.components * o.cells * o.cells;
  Batch<double> pairs(2, modes);
  stream.normals(pairs.data(), pairs.size());
  const Vector<double> real = pairs.row(0), imaginary = pairs.row(1);
  return smooth_noise(o, real, imaginary);
}

}  // namespace physinv::fluid
