#include "optimizers/half_inverse/tridiagonal_qr.h"

#include <cmath>
#include <limits>

namespace physinv::hig {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr Index kSweepsPerRow = 60;
/// Below this the sum of two squares has lost digits.
constexpr double kTinySquare = 1e-280;

/// The eigenvalue of the last 2 x 2 block that is nearer to its last entry.
double wilkinson(double a, double b, double off) {
  const double half = 0.5 * (a - b);
  if (off == 0) return b;
  const double ratio = half / off;
  const double root = std::hypot(ratio, 1.0);
  return b - off / (ratio + std::copysign(root, ratio));
}

}  // namespace

// The recurrence of LAPACK's dsteqr: one square root and one division on the
// path from rotation to rotation.
void TridiagonalQr::sweep(
    double* d, double* e, double* x, Index start, Index end) {
  const Index count = end - start;
  const std::size_t base = cosine_.size();
  cosine_.resize(base + static_cast<std::size_t>(count));
  sine_.resize(base + static_cast<std::size_t>(count));
  double* const cosine = cosine_.data() + base;
  double* const sine = sine_.data() + base;

  double g = d[start] - wilkinson(d[end - 1], d[end], e[end - 1]);
  double c = 1, s = 1, p = 0;
  double head = x[start];
  for (Index k = 0; k < count; ++k) {
    const Index i = start + k;
    const double f = s * e[i], b = c * e[i];
    const double square = g * g + f * f;
    double r;
    if (square > kTinySquare) [[likely]] {
      r = std::sqrt(square);
      const double inverse = 1 / r;
      c = g * inverse, s = f * inverse;
    } else {
      r = std::hypot(g, f);
      c = r == 0 ? 1 : g / r;
      s = r == 0 ? 0 : f / r;
    }
    if (k > 0) e[i - 1] = r;
    g = d[i] - p;
    r = (d[i + 1] - g) * s + 2 * c * b;
    p = s * r;
    d[i] = g + p;
    g = c * r - b;
    cosine[k] = c, sine[k] = s;
    const double next = x[i + 1];
    x[i] = s * next + c * head;
    head = c * next - s * head;
  }
  x[end] = head;
  d[end] -= p;
  e[end - 1] = g;
  sweeps_.push_back({start, count});
}

bool TridiagonalQr::run(VectorOut<double> d,
                        VectorOut<double> e,
                        VectorOut<double> x) {
  sweeps_.clear(), cosine_.clear(), sine_.clear();
  const auto negligible = [&](Index i) {
    return std::abs(e(i)) <= kEpsilon * (std::abs(d(i)) + std::abs(d(i + 1)));
  };
  const Index n = d.size(), limit = kSweepsPerRow * n;
  for (Index end = n - 1; end > 0;) {
    if (negligible(end - 1)) {
      e(--end) = 0;
      continue;
    }
    Index start = end - 1;
    while (start > 0 && !negligible(start - 1)) --start;
    if (start > 0) e(start - 1) = 0;
    if (sweeps() == limit) return false;
    sweep(d.data(), e.data(), x.data(), start, end);
  }
  return true;
}

void TridiagonalQr::apply(VectorOut<double> vector) const {
  double* const x = vector.data();
  const double* cosine = cosine_.data() + cosine_.size();
  const double* sine = sine_.data() + sine_.size();
  for (auto sweep = sweeps_.rbegin(); sweep != sweeps_.rend(); ++sweep) {
    double carried = x[sweep->start + sweep->count];
    for (Index i = sweep->start + sweep->count - 1; i >= sweep->start; --i) {
      const double c = *--cosine, s = *--sine, low = x[i];
      x[i + 1] = s * low + c * carried;
      carried = c * low - s * carried;
    }
    x[sweep->start] = carried;
  }
}

}  // namespace physinv::hig
