#include "suite/linalg/bidiagonal.h"

#include <algorithm>

#include "suite/linalg/householder.h"

namespace physinv::linalg {
namespace {

double* reserve(Buffer& buffer, Index count) {
  return static_cast<double*>(
      buffer.reserve(static_cast<std::size_t>(count) * sizeof(double)));
}

/// What a step does to each column of what is left, on rows [begin, end).
struct Step {
  double *m, *u, *y, *z;
  Index stride, begin;
  const double* v;  ///< right reflector of the step before, null for none
  double left_tau;
};

/// Columns from k on; row[j] gets their entries in row k, z the product with
/// them. K registers hold the rows, 0 for any number.
template <int K>
void run(const Step& s, Index k, Index n, double* row) {
  if constexpr (K == 0) {
    const Index length = s.stride - s.begin;
    for (Index j = k; j < n; ++j) {
      double* const x = s.m + j * s.stride + s.begin;
      if (s.v != nullptr) axpy(length, -s.v[j], s.y + s.begin, x);
      axpy(length,
           -s.left_tau * dot(length, s.u + s.begin, x),
           s.u + s.begin,
           x);
      row[j] = x[k - s.begin];
      axpy(length, row[j], x, s.z + s.begin);
    }
  } else {
    Pack8 u[K], y[K], z[K];
#pragma GCC unroll 8
    for (int i = 0; i < K; ++i) {
      u[i] = load(s.u + s.begin + i * kWidth);
      y[i] = load(s.y + s.begin + i * kWidth);
      z[i] = Pack8{};
    }
    for (Index j = k; j < n; ++j) {
      double* const at = s.m + j * s.stride + s.begin;
      const Pack8 off = broadcast(s.v != nullptr ? -s.v[j] : 0.0);
      Pack8 x[K], along{};
#pragma GCC unroll 8
      for (int i = 0; i < K; ++i) {
        x[i] = fma_lanes(off, y[i], load(at + i * kWidth));
        along = fma_lanes(u[i], x[i], along);
      }
      const Pack8 left = broadcast(-s.left_tau * sum_of(along));
#pragma GCC unroll 8
      for (int i = 0; i < K; ++i) {
        x[i] = fma_lanes(left, u[i], x[i]);
        store(at + i * kWidth, x[i]);
      }
      row[j] = at[k - s.begin];
      const Pack8 entry = broadcast(row[j]);
#pragma GCC unroll 8
      for (int i = 0; i < K; ++i) z[i] = fma_lanes(entry, x[i], z[i]);
    }
#pragma GCC unroll 8
    for (int i = 0; i < K; ++i) store(s.z + s.begin + i * kWidth, z[i]);
  }
}

void run_any(const Step& s, Index k, Index n, double* row) {
  switch ((s.stride - s.begin) / kWidth) {
    case 1:
      return run<1>(s, k, n, row);
    case 2:
      return run<2>(s, k, n, row);
    case 3:
      return run<3>(s, k, n, row);
    case 4:
      return run<4>(s, k, n, row);
    case 5:
      return run<5>(s, k, n, row);
    case 6:
      return run<6>(s, k, n, row);
    case 7:
      return run<7>(s, k, n, row);
    case 8:
      return run<8>(s, k, n, row);
    default:
      return run<0>(s, k, n, row);
  }
}

}  // namespace

void Bidiagonal::reduce(BatchIn<double> r, VectorIn<double> h) {
  const Index n = h.size();
  stride_ = round_up(n, kWidth);
  a_.resize(n), b_.resize(std::max<Index>(n - 1, 0)), tau_.setZero(n);
  double* const m = reserve(memory_, stride_ * (n + 4));
  double* const right = reserve(reflectors_, stride_ * n);
  double* const u = m + stride_ * n;  // left reflector, zero above its head
  double* const y = u + stride_;      // what the last right one takes off
  double* const z = y + stride_;
  std::fill_n(u, 3 * stride_, 0.0);
  for (Index j = 0; j < n; ++j) {
    std::copy_n(r.col(j).data(), n, m + j * stride_);
    std::fill_n(m + j * stride_ + n, stride_ - n, 0.0);
  }
  std::copy_n(h.data(), n, u);
  double left_tau = reflect(n, u, alpha_);

  // One pass over the columns per step: the right reflector of the step
  // before, the left one, and the product that the next right one needs.
  const double* v = nullptr;
  double right_tau = 0;
  for (Index k = 0; k < n; ++k) {
    // Rows below this belong to L already.
    const Index begin = k / kWidth * kWidth;
    double* const row = right + k * stride_;
    std::fill_n(row, stride_, 0.0);
    std::fill(z + begin, z + stride_, 0.0);
    run_any({.m = m,
             .u = u,
             .y = y,
             .z = z,
             .stride = stride_,
             .begin = begin,
             .v = right_tau != 0 ? v : nullptr,
             .left_tau = left_tau},
            k,
            n,
            row);
    right_tau = tau_(k) = reflect(n - k, row + k, a_(k));
    v = row;
    if (k + 1 == n) break;
    // M v tau: v = (row - a e_k) / (head - a), 1 at its head.
    if (right_tau != 0) {
      const double head = m[k * stride_ + k];
      const double factor = right_tau / (head - a_(k));
      const double* const first = m + k * stride_;
      for (Index i = begin; i < stride_; ++i)
        y[i] = factor * (z[i] - a_(k) * first[i]);
    }
    // Column k as the right reflector leaves it gives the next left one.
    std::fill(u + begin, u + k + 1, 0.0);
    for (Index i = k + 1; i < n; ++i)
      u[i] = m[k * stride_ + i] - (right_tau != 0 ? y[i] : 0.0);
    left_tau = reflect(n - k - 1, u + k + 1, b_(k));
    if (left_tau == 0) std::fill(u + begin, u + stride_, 0.0);
  }
}

void Bidiagonal::apply(VectorOut<double> x) const {
  const Index n = a_.size();
  const auto* right = static_cast<const double*>(reflectors_.data());
  for (Index k = n - 1; k >= 0; --k) {
    if (tau_(k) == 0) continue;
    const double* v = right + k * stride_ + k;
    axpy(n - k, -tau_(k) * dot(n - k, v, x.data() + k), v, x.data() + k);
  }
}

}  // namespace physinv::linalg
