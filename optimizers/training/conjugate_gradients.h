/// Conjugate gradients, without a preconditioner, for A s = b with a symmetric
/// positive matrix known by its products, ended as Martens (2010) has it: when
/// the model
///
///   m_i = s_i . (r_i - b) / 2 = s.As / 2 - b.s,   r_i = A s_i - b,
///
/// no longer falls: at iteration i > k = max(10, i / 10) with
/// (m_i - m_{i-k}) / (m_i - m_0) < progress; or at the last iteration allowed,
/// a small residual, or a number that is not finite.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/options.h"
#include "suite/core/unit_of.h"

namespace physinv {

struct ConjugateGradientOptions {
  Index iterations = 250;
  double progress = 5e-4;
  double residual = 1e-5;  ///< |r| < residual |b|

  auto fields() const {
    return std::tuple{field("cg_iterations", iterations),
                      field("cg_progress", progress),
                      field("cg_residual", residual)};
  }
};

struct ConjugateGradientPath {
  std::vector<double> model;  ///< m_0, m_1, ..
  /// Iterates 0 and ceil(1.3^j) - 1, and the last.
  std::vector<std::pair<Index, Vector<double>>> stored;

  Index iterations() const { return static_cast<Index>(model.size()) - 1; }
};

/// Summed in order, whatever the registers.
inline double dot(const Vector<double>& a, const Vector<double>& b) {
  double sum = 0;
  for (Index i = 0; i < a.size(); ++i) sum = std::fma(a(i), b(i), sum);
  return sum;
}

/// product(d, Ad)
template <class F>
ConjugateGradientPath conjugate_gradients(
    F&& product,
    const Vector<double>& b,
    Vector<double> s,
    const ConjugateGradientOptions& options) {
  ConjugateGradientPath path;
  if (b.size() == 0) return path;
  const double unit =
      unit_of(std::max(b.cwiseAbs().maxCoeff(), s.cwiseAbs().maxCoeff()));
  if (unit != 1) {
    path = conjugate_gradients(product, b / unit, s / unit, options);
    for (double& m : path.model) m = m * unit * unit;
    for (auto& [i, iterate] : path.stored) iterate *= unit;
    return path;
  }
  Vector<double> r(b.size()), a_d(b.size());
  if (s.isZero(0)) {
    r = -b;
  } else {
    product(s, r);
    r -= b;
  }
  Vector<double> d = -r;
  double square = dot(r, r);
  const double enough = options.residual * std::sqrt(dot(b, b));
  const auto note = [&] { path.model.push_back(0.5 * dot(s, r - b)); };
  const auto ended = [&](Index i) {
    const auto& m = path.model;
    const auto now = static_cast<std::size_t>(i);
    const Index k = std::max<Index>(10, i / 10);
    if (!std::isfinite(m[now]) || !std::isfinite(square)) return true;
    if (i == options.iterations || std::sqrt(square) < enough) return true;
    return k < i &&
           (m[now] - m[static_cast<std::size_t>(i - k)]) / (m[now] - m[0]) <
               options.progress;
  };
  note();
  path.stored.emplace_back(0, s);
  if (square == 0) return path;
  double due = 1;  // 1.3^j
  for (Index i = 0; i < options.iterations;) {
    ++i;
    product(d, a_d);
    const double alpha = square / dot(d, a_d);
    for (Index j = 0; j < s.size(); ++j) {
      s(j) = std::fma(alpha, d(j), s(j));
      r(j) = std::fma(alpha, a_d(j), r(j));
    }
    const double before = std::exchange(square, dot(r, r));
    note();
    const bool last = ended(i);
    while (std::ceil(due) - 1 < double(i)) due *= 1.3;
    if (last || std::ceil(due) - 1 == double(i)) path.stored.emplace_back(i, s);
    if (last) break;
    const double beta = square / before;
    for (Index j = 0; j < d.size(); ++j) d(j) = std::fma(beta, d(j), -r(j));
  }
  return path;
}

}  // namespace physinv
