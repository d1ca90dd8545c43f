#include "optimizers/steps/limited_memory.h"

#include <algorithm>
#include <cmath>

#include "optimizers/steps/bfgs_update.h"

namespace physinv {
namespace {

/// Lower Cholesky factor of the leading k x k block, in place.
bool cholesky(Index k, Batch<double>& a) {
  for (Index j = 0; j < k; ++j) {
    for (Index i = j; i < k; ++i)
      for (Index l = 0; l < j; ++l)
        a(i, j) = std::fma(-a(i, l), a(j, l), a(i, j));
    if (!(a(j, j) > 0)) return false;
    a(j, j) = std::sqrt(a(j, j));
    for (Index i = j + 1; i < k; ++i) a(i, j) /= a(j, j);
  }
  return true;
}

/// v <- L^-1 v and v <- L'^-1 v.
void solve_lower(Index k, const Batch<double>& l, double* v) {
  for (Index i = 0; i < k; ++i) {
    for (Index j = 0; j < i; ++j) v[i] = std::fma(-l(i, j), v[j], v[i]);
    v[i] /= l(i, i);
  }
}
void solve_upper(Index k, const Batch<double>& l, double* v) {
  for (Index i = k - 1; i >= 0; --i) {
    for (Index j = i + 1; j < k; ++j) v[i] = std::fma(-l(j, i), v[j], v[i]);
    v[i] /= l(i, i);
  }
}

/// The oldest of m pairs leaves a table of their products.
void drop_first(Index m, Batch<double>& table) {
  for (Index j = 0; j + 1 < m; ++j)
    for (Index i = 0; i + 1 < m; ++i) table(i, j) = table(i + 1, j + 1);
}

}  // namespace

void SaddleFactor::reserve(Index k) {
  p_.setZero(k, k);
  g_.setZero(k, k);
  t_.setZero(k, k);
}

bool SaddleFactor::factor(Index k,
                          const Batch<double>& p,
                          const Batch<double>& r,
                          const Batch<double>& q) {
  for (Index j = 0; j < k; ++j) {
    for (Index i = 0; i < k; ++i) {
      p_(i, j) = p(i, j);
      g_(i, j) = r(j, i);
      t_(i, j) = q(i, j);
    }
  }
  if (!cholesky(k, p_)) return false;
  for (Index j = 0; j < k; ++j) solve_lower(k, p_, g_.col(j).data());
  for (Index j = 0; j < k; ++j)
    for (Index i = j; i < k; ++i)
      t_(i, j) += dense::dot(k, g_.col(i).data(), g_.col(j).data());
  return cholesky(k, t_);
}

void SaddleFactor::solve(Index k, const double* b, double* v) const {
  // u = P^-1/2 b1, (Q + G'G) v2 = b2 + G'u, v1 = P'^-1/2 (G v2 - u).
  if (v != b) std::copy(b, b + 2 * k, v);
  double* upper = v;
  double* lower = v + k;
  solve_lower(k, p_, upper);
  for (Index i = 0; i < k; ++i)
    lower[i] += dense::dot(k, g_.col(i).data(), upper);
  solve_lower(k, t_, lower);
  solve_upper(k, t_, lower);
  for (Index i = 0; i < k; ++i) upper[i] = -upper[i];
  for (Index j = 0; j < k; ++j)
    for (Index i = 0; i < k; ++i)
      dense::add_product(upper[i], g_(i, j), lower[j]);
  solve_upper(k, p_, upper);
}

void LimitedMemory::start(Index d, Index m) {
  d_ = d;
  m_ = m;
  s_.resize(d, m);
  y_.resize(d, m);
  for (Batch<double>* table : {&ss_, &sy_, &yy_, &p_, &r_, &q_})
    table->setZero(m, m);
  w_.resize(2 * m);
  middle_.reserve(m);
  subspace_.reserve(m);
  clear();
}

void LimitedMemory::clear() {
  pairs_ = 0;
  theta_ = 1;
}

bool LimitedMemory::update(const double* step,
                           const double* change,
                           double sy) {
  if (pairs_ == m_) {
    oldest_ = (oldest_ + 1) % m_;
    for (Batch<double>* table : {&ss_, &sy_, &yy_}) drop_first(m_, *table);
    --pairs_;
  }
  const Index last = pairs_++;
  const Index column = (oldest_ + last) % m_;
  std::copy(step, step + d_, s_.col(column).data());
  std::copy(change, change + d_, y_.col(column).data());
  for (Index j = 0; j <= last; ++j) {
    const auto [ss, yy, sy_last, sy_j] = dense::dots<4>(
        d_, {step, change, step, s(j)}, {s(j), y(j), y(j), change});
    ss_(last, j) = ss_(j, last) = ss;
    yy_(last, j) = yy_(j, last) = yy;
    sy_(last, j) = sy_last;
    sy_(j, last) = sy_j;
  }
  sy_(last, last) = sy;
  theta_ = yy_(last, last) / sy;

  for (Index j = 0; j < pairs_; ++j) {
    for (Index i = 0; i < pairs_; ++i) {
      p_(i, j) = i == j ? sy_(i, j) : 0;
      r_(i, j) = i > j ? sy_(i, j) : 0;
      q_(i, j) = theta_ * ss_(i, j);
    }
  }
  const bool regular = middle_.factor(pairs_, p_, r_, q_);
  if (!regular) clear();
  return regular;
}

void LimitedMemory::project(const double* v, double* out) const {
  for (Index j = 0; j < pairs_; j += 2) {
    const Index next = std::min(j + 1, pairs_ - 1);
    const auto products =
        dense::dots<4>(d_, {y(j), y(next), s(j), s(next)}, {v, v, v, v});
    out[j] = products[0], out[next] = products[1];
    out[pairs_ + j] = theta_ * products[2];
    out[pairs_ + next] = theta_ * products[3];
  }
}

void LimitedMemory::expand(const double* w, double* v) const {
  for (Index j = 0; j < pairs_; ++j) {
    const double *yj = y(j), *sj = s(j);
    const double ws = theta_ * w[pairs_ + j];
    for (Index i = 0; i < d_; ++i)
      v[i] = std::fma(ws, sj[i], std::fma(w[j], yj[i], v[i]));
  }
}

void LimitedMemory::row(Index i, double* out) const {
  for (Index j = 0; j < pairs_; ++j) {
    out[j] = y(j)[i];
    out[pairs_ + j] = theta_ * s(j)[i];
  }
}

/// a.b over the free unknowns, or over those that are held.
double LimitedMemory::free_dot(std::span<const char> free,
                               bool held,
                               const double* a,
                               const double* b) const {
  double sum = 0;
  for (Index i = 0; i < d_; ++i)
    if ((free[static_cast<std::size_t>(i)] == 0) == held)
      dense::add_product(sum, a[i], b[i]);
  return sum;
}

/// (Z'BZ)^-1 = (1/theta) (I + (1/theta) Z'W K^-1 W'Z) with
/// K = M^-1 - (1/theta) W'ZZ'W. Where the sum over free unknowns would cancel
/// what M^-1 has, the sum over the held ones is taken.
bool LimitedMemory::solve_free(std::span<const char> free, double* r) {
  const bool all = std::find(free.begin(), free.end(), 0) == free.end();
  for (Index j = 0; j < pairs_; ++j) {
    for (Index i = 0; i < pairs_; ++i) {
      const auto product = [&](const double* a,
                               const double* b,
                               const Batch<double>& whole,
                               bool held) {
        if (all) return held ? 0.0 : whole(i, j);
        return free_dot(free, held, a, b);
      };
      r_(i, j) = i > j ? product(s(i), y(j), sy_, true)
                       : -product(s(i), y(j), sy_, false);
      if (i < j) continue;  // of the symmetric two the lower part is enough
      p_(i, j) =
          (i == j ? sy_(i, j) : 0) + product(y(i), y(j), yy_, false) / theta_;
      q_(i, j) = theta_ * product(s(i), s(j), ss_, true);
    }
  }
  if (!subspace_.factor(pairs_, p_, r_, q_)) return false;
  project(r, w_.data());
  subspace_.solve(pairs_, w_.data(), w_.data());
  for (Index i = 0; i < 2 * pairs_; ++i) w_(i) /= theta_;
  expand(w_.data(), r);
  for (Index i = 0; i < d_; ++i)
    r[i] = free[static_cast<std::size_t>(i)] != 0 ? r[i] / theta_ : 0;
  return true;
}

}  // namespace physinv
