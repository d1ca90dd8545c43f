#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "problems/kuramoto_sivashinsky/checkpoints.h"
#include "problems/kuramoto_sivashinsky/etdrk2.h"
#include "suite/core/check.h"
#include "suite/core/threads.h"

namespace physinv {
namespace {

enum Slot : std::size_t { kUnknowns, kLost, kStates, kScratch };

template <class T>
constexpr T kNan = std::numeric_limits<T>::quiet_NaN();

/// cos and sin of 2 pi j / n.
struct Circle {
  explicit Circle(Index n) : cos(n), sin(n) {
    for (Index j = 0; j < n; ++j) {
      const double angle = 2 * std::numbers::pi * double(j) / double(n);
      cos(j) = std::cos(angle), sin(j) = std::sin(angle);
    }
  }
  Vector<double> cos, sin;
};

/// Smoothed noise: modes times 1 / q^2, q = 10 m / box, summed as they are
/// (the samples are few, and their bits must not hang on an FFT).
void draw_state(const KuramotoSivashinskyOptions& o,
                const Circle& circle,
                Stream& stream,
                Eigen::Ref<Vector<double>> u) {
  const Index n = o.cells;
  u.setZero();
  for (Index i = 0; i < n; ++i) {
    const double re = stream.normal(), im = stream.normal();
    const Index m = i < n / 2 ? i : i - n;
    const double q = 10 * double(m) / o.box;
    if (q * q <= 0.1) continue;
    const double w = 1 / (q * q);
    for (Index j = 0, at = 0; j < n; ++j, at = (at + i) & (n - 1))
      u(j) += w * (re * circle.cos(at) - im * circle.sin(at));
  }
  const double mean = u.mean();
  const double deviation = std::sqrt((u.array() - mean).square().mean());
  for (Index j = 0; j < n; ++j) u(j) = (u(j) - mean) / deviation;
}

/// A sample under way, in 3 `stride` reals of memory.
template <class T>
typename Etdrk2<T>::Run run_of(VectorIn<T> x, const Etdrk2<T>& k, T* memory) {
  const Index h = k.stride();
  return {x(0), x(1), memory, memory + h, memory + 2 * h};
}

/// A last state goes out, as NaN unless all of it is finite; says whether.
template <class T>
bool finish(const T* u, Eigen::Ref<Vector<T>> y) {
  y = Eigen::Map<const Vector<T>>(u, y.size());
  const bool finite = y.allFinite();
  if (!finite) y.setConstant(kNan<T>);
  return finite;
}

/// Runs body(sample, workspace) for every sample; returns the sum of what the
/// bodies return.
template <class F>
std::uint64_t sum_samples(Workspace& work, Index count, F&& body) {
  const bool threaded =
      work.threads() != nullptr && work.threads()->count() > 1;
  if (threaded) work.of_thread(0);  // makes all of them, before they run
  std::atomic<std::uint64_t> sum = 0;
  for_blocks(work.threads(), count, [&](Index i, int thread) {
    Workspace& mine = threaded ? work.of_thread(thread) : work;
    const Workspace::Scope scope(mine);
    sum += static_cast<std::uint64_t>(body(i, mine));
  });
  return sum;
}

}  // namespace

Options describe(const KuramotoSivashinskyOptions& o) {
  return {{"cells", fmt::format("{}", o.cells)},
          {"box", fmt::format("{}", o.box)},
          {"time_step", fmt::format("{}", o.time_step)},
          {"steps", fmt::format("{}", o.steps)},
          {"prior_low", fmt::format("{}", o.prior_low)},
          {"prior_high", fmt::format("{}", o.prior_high)},
          {"start", fmt::format("{},{}", o.start[0], o.start[1])},
          {"tape_budget", fmt::format("{}", o.tape_budget)}};
}

template <class T>
KuramotoSivashinsky<T>::KuramotoSivashinsky(const Options& o) : options_(o) {
  SUITE_CHECK(o.cells >= 16 && (o.cells & (o.cells - 1)) == 0,
              "cells must be a power of two, at least 16");
  SUITE_CHECK(o.box > 0 && o.time_step > 0 && o.steps > 0,
              "box, time step and number of steps must be positive");
  SUITE_CHECK(o.prior_low <= o.prior_high, "the prior has no width");
  kernel_ = std::make_shared<const Etdrk2<T>>(operators(o));
}

template <class T>
Shape KuramotoSivashinsky<T>::shape() const {
  return {2, options_.cells, options_.cells};
}

template <class T>
Vector<double> KuramotoSivashinsky<T>::start() const {
  return Eigen::Vector2d(options_.start[0], options_.start[1]);
}

template <class T>
double KuramotoSivashinsky<T>::operations() const {
  const double n = double(options_.cells);
  return double(options_.steps) * n * (4 * 2.5 * std::log2(n) + 12);
}

template <class T>
Samples<double> KuramotoSivashinsky<T>::sample(Index first,
                                               Index count,
                                               const Rng& rng) const {
  const Index n = options_.cells;
  const Circle circle(n);
  Samples<double> out;
  out.x.resize(2, count), out.y.resize(n, count), out.given.resize(n, count);
  for (Index i = 0; i < count; ++i) {
    Stream stream = rng.child(static_cast<std::uint64_t>(first + i)).stream();
    for (Index j = 0; j < 2; ++j)
      out.x(j, i) = stream.uniform(options_.prior_low, options_.prior_high);
    draw_state(options_, circle, stream, out.given.col(i));
  }
  Workspace work;
  KuramotoSivashinsky<double>(options_).forward(out.x, out.given, out.y, work);
  return out;
}

template <class T>
void KuramotoSivashinsky<T>::forward(BatchIn<T> x,
                                     BatchIn<T> given,
                                     BatchOut<T> y,
                                     Workspace& work) const {
  const Etdrk2<T>& k = *kernel_;
  const Index n = k.cells(), steps = options_.steps;
  check_size(x, 2, x.cols());
  check_size(given, n, x.cols());
  check_size(y, n, x.cols());
  work.counts[Counter::skipped_steps] +=
      sum_samples(work, x.cols(), [&](Index i, Workspace& mine) {
        auto u = mine.take<T>(n, 3);
        const auto r =
            run_of<T>(x.col(i), k, mine.take<T>(3 * k.stride(), 1).data());
        const auto state = [&](Index t) { return u.col(t % 2).data(); };
        u.col(0) = given.col(i);
        k.begin(r, state(0));
        Index end = steps;
        if (r.beta == 0) {  // linear: the modes go their own ways
          for (Index t = 0; t < steps; ++t) k.drift(r);
          k.restore(r, state(end));
        } else {
          end = march(
              k, r, 0, steps, state, [&](Index) { return u.col(2).data(); });
        }
        finish<T>(state(end), y.col(i));
        return steps - end;
      });
}

template <class T>
void KuramotoSivashinsky<T>::linearize(BatchIn<T> x,
                                       BatchIn<T> given,
                                       BatchOut<T> y,
                                       Tape& tape) const {
  const Etdrk2<T>& k = *kernel_;
  const Index n = k.cells(), steps = options_.steps;
  check_size(x, 2, x.cols());
  check_size(given, n, x.cols());
  check_size(y, n, x.cols());
  const Keeping keep(options_, k, x.cols());
  const Index threads = tape.threads() != nullptr ? tape.threads()->count() : 1;
  auto states = tape.slot<T>(kStates, keep.rows, x.cols());
  auto scratch = tape.slot<T>(kScratch, 3 * k.stride() + 3 * n, threads);
  auto lost = tape.slot<unsigned char>(kLost, 1, x.cols());
  tape.slot<T>(kUnknowns, 2, x.cols()) = x;

  std::atomic<std::uint64_t> skipped = 0;
  for_blocks(tape.threads(), x.cols(), [&](Index i, int thread) {
    T* const u = scratch.col(thread).data();
    T* const kept = states.col(i).data();
    const auto r = run_of<T>(x.col(i), k, u + 3 * n);
    const bool all = keep.segment == 0;
    const auto state = [=](Index t) {
      return all ? kept + 2 * t * n : u + t % 2 * n;
    };
    const auto between = [=](Index t) {
      return all ? kept + (2 * t + 1) * n : u + 2 * n;
    };
    Eigen::Map<Vector<T>>(state(0), n) = given.col(i);
    k.begin(r, state(0));
    Index end = 0, to = all ? steps : 0;
    while (end < steps) {
      if (!all) {
        T* const start = kept + end / keep.segment * keep.stride;
        std::copy_n(state(end), n, start);
        std::copy_n(r.s, n + 2, start + n);
        to = std::min(steps, end + keep.segment);
      }
      end = march(k, r, end, to, state, between);
      if (!std::isfinite(state(end)[0])) break;
    }
    lost(0, i) = !finish<T>(state(end), y.col(i));
    skipped += static_cast<std::uint64_t>(steps - end);
  });
  tape.counts[Counter::skipped_steps] += skipped;
}

template <class T>
void KuramotoSivashinsky<T>::pullback(const Tape& tape,
                                      BatchIn<T> y_bar,
                                      BatchOut<T> x_bar,
                                      Workspace& work) const {
  pull(tape, y_bar, x_bar, nullptr, work);
}

template <class T>
void KuramotoSivashinsky<T>::pullback(const Tape& tape,
                                      BatchIn<T> y_bar,
                                      BatchOut<T> x_bar,
                                      BatchOut<T> given_bar,
                                      Workspace& work) const {
  check_size(given_bar, options_.cells, y_bar.cols());
  pull(tape, y_bar, x_bar, &given_bar, work);
}

template <class T>
void KuramotoSivashinsky<T>::pull(const Tape& tape,
                                  BatchIn<T> y_bar,
                                  BatchOut<T>& x_bar,
                                  BatchOut<T>* given_bar,
                                  Workspace& work) const {
  const Etdrk2<T>& k = *kernel_;
  const auto x = tape.view<T>(kUnknowns);
  const auto states = tape.view<T>(kStates);
  const auto lost = tape.view<unsigned char>(kLost);
  const Index n = k.cells(), h = k.stride();
  check_size(y_bar, n, x.cols());
  check_size(x_bar, 2, x.cols());
  const Keeping keep(options_, k, x.cols());

  work.counts[Counter::skipped_vjp] +=
      sum_samples(work, x.cols(), [&](Index i, Workspace& mine) {
        // What is lost ends as NaN whatever is done, zeros remain zeros.
        if (lost(0, i) != 0 || (y_bar.col(i).array() == 0).all()) {
          const T end = lost(0, i) != 0 ? kNan<T> : T(0);
          x_bar.col(i).setConstant(end);
          if (given_bar != nullptr) given_bar->col(i).setConstant(end);
          return 1;
        }
        auto lambda = mine.take<T>(n, 1);
        auto sum = mine.take<T>(h, 2);
        const auto r = run_of<T>(x.col(i), k, mine.take<T>(3 * h, 1).data());
        const typename Etdrk2<T>::Sums sums{sum.col(0).data(),
                                            sum.col(1).data()};
        sum.setZero();
        lambda = y_bar.col(i);
        k.begin(r, lambda.data());
        pull_steps(
            k, r, sums, options_.steps, keep, states.col(i).data(), mine);
        x_bar(0, i) = k.alpha_bar(sums), x_bar(1, i) = k.beta_bar(sums);
        if (given_bar != nullptr) {
          k.restore(r, lambda.data());
          given_bar->col(i) = lambda;
        }
        return 0;
      });
}

template <class T>
void KuramotoSivashinsky<T>::jacobian(BatchIn<T> x,
                                      BatchIn<T> given,
                                      BatchOut<T> j,
                                      Workspace& work) const {
  const Etdrk2<T>& k = *kernel_;
  const Index n = k.cells(), h = k.stride(), steps = options_.steps;
  check_size(x, 2, x.cols());
  check_size(given, n, x.cols());
  check_size(j, 2 * n, x.cols());
  work.counts[Counter::skipped_steps] +=
      sum_samples(work, x.cols(), [&](Index i, Workspace& mine) {
        auto u = mine.take<T>(n, 3);
        auto d = mine.take<T>(2 * h, 5);
        const auto r = run_of<T>(x.col(i), k, mine.take<T>(3 * h, 1).data());
        const typename Etdrk2<T>::Tangents along{d.col(0).data(),
                                                 d.col(1).data(),
                                                 d.col(2).data(),
                                                 d.col(3).data(),
                                                 d.col(4).data()};
        d.setZero();
        u.col(0) = given.col(i);
        k.begin(r, u.col(0).data());
        Index end = 0;
        bool finite = true;
        while (end < steps && finite) {
          const T* const now = u.col(end % 2).data();
          T* const next = u.col(++end % 2).data();
          k.step(r, now, u.col(2).data(), next);
          k.tangent_step(r.beta, now, u.col(2).data(), along);
          finite = std::isfinite(next[0]);
        }
        j.col(i) = d.col(1).head(2 * n);
        if (!u.col(end % 2).allFinite()) j.col(i).setConstant(kNan<T>);
        return steps - end;
      });
}

template <class T>
Index KuramotoSivashinsky<T>::gradient_block() const {
  const auto bytes =
      2 * options_.steps * options_.cells * static_cast<Index>(sizeof(T));
  return std::max<Index>(4, (Index{1} << 19) / bytes);
}

template <class T>
Batch<T> KuramotoSivashinsky<T>::trajectory(VectorIn<T> x,
                                            VectorIn<T> given) const {
  const Etdrk2<T>& k = *kernel_;
  const Index n = k.cells(), steps = options_.steps;
  check_size(x, 2, 1);
  check_size(given, n, 1);
  Workspace work;
  auto u = work.take<T>(n, steps + 2);  // and the middle stage
  const auto r = run_of<T>(x, k, work.take<T>(3 * k.stride(), 1).data());
  const auto state = [&](Index t) { return u.col(t).data(); };
  u.col(0) = given;
  k.begin(r, state(0));
  const Index end =
      march(k, r, 0, steps, state, [&](Index) { return state(steps + 1); });
  if (!u.col(end).allFinite())
    u.middleCols(end, steps + 1 - end).setConstant(kNan<T>);
  return u.leftCols(steps + 1);
}

template class KuramotoSivashinsky<float>;
template class KuramotoSivashinsky<double>;

}  // namespace physinv
