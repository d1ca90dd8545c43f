/// The projection onto fields without divergence on a periodic square, by real
/// transforms along y and then, of the real and of the imaginary parts, along
/// x: the Laplacian's eigenvalues are real and even, so neither needs more.
#pragma once

#include <numbers>
#include <vector>

#include "problems/fluid/staggered.h"
#include "suite/core/lanes_fft.h"
#include "suite/core/math.h"

namespace physinv::fluid {

template <class T>
class PeriodicProjection {
 public:
  /// `cells` per side, a power of two.
  explicit PeriodicProjection(Index cells)
      : faces_(cells, cells), fft_(cells), value_(cells / 2 + 1) {
    for (Index p = 0; p <= cells / 2; ++p)
      value_[p] = 2 - 2 * math::cos(2 * std::numbers::pi *
                                    double(fft_.mode(p)) / double(cells));
  }

  const Staggering<Edge::periodic>& faces() const { return faces_; }

  /// An orthogonal projection, so its own adjoint. Padding is neither read nor
  /// written.
  template <class P>
  void project(P* u, P* v, P* scratch) const {
    const Plane& g = faces_.cells;
    const Index n = g.rows, stride = g.stride;
    P* const d = scratch;
    P* const line = scratch + g.size();  // of n + 2
    P* const point = line + n + 2;       // of n
    const auto next = [&](Index i) { return i + 1 < n ? i + 1 : 0; };
    g.for_points([&](Index i, Index j, Index at) {
      d[i * stride + j] =
          (u[g.at(next(i), j)] - u[at]) + (v[g.at(i, next(j))] - v[at]);
    });
    for (Index i = 0; i < n; ++i) {
      std::copy_n(d + i * stride, n, point);
      fft_.forward(point, d + i * stride);
    }
    for (Index c = 0; c < n + 2; ++c) solve(d + c, value_[c / 2], point, line);
    for (Index i = 0; i < n; ++i) {
      std::copy_n(d + i * stride, n + 2, line);
      fft_.inverse(line, d + i * stride);
    }
    // d is the pressure with the opposite sign.
    const auto last = [&](Index i) { return i > 0 ? i - 1 : n - 1; };
    g.for_points([&](Index i, Index j, Index at) {
      u[at] += d[i * stride + j] - d[last(i) * stride + j];
      v[at] += d[i * stride + j] - d[i * stride + last(j)];
    });
  }

 private:
  /// One mode along y: divides by the eigenvalues, and by what two transforms
  /// there and back multiply with.
  template <class P>
  void solve(P* d, double value, P* point, P* line) const {
    const Index n = fft_.size(), stride = faces_.cells.stride;
    for (Index i = 0; i < n; ++i) point[i] = d[i * stride];
    fft_.forward(point, line);
    for (Index p = 0; p <= n / 2; ++p) {
      const double sum = value + value_[p];
      const T factor =
          static_cast<T>(sum > 1e-12 ? 1 / (sum * double(n * n)) : 0);
      line[2 * p] *= factor, line[2 * p + 1] *= factor;
    }
    fft_.inverse(line, point);
    for (Index i = 0; i < n; ++i) d[i * stride] = point[i];
  }

  Staggering<Edge::periodic> faces_;
  LanesFft<T> fft_;
  std::vector<double> value_;  ///< of -d^2/dx^2, in the order of positions
};

}  // namespace physinv::fluid
