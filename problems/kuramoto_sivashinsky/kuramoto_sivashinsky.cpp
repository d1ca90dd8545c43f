#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "problems/kuramoto_sivashinsky/blocks.h"
#include "problems/kuramoto_sivashinsky/checkpoints.h"
#include "problems/kuramoto_sivashinsky/etdrk2.h"
#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"
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
      cos(j) = math::cos(angle), sin(j) = math::sin(angle);
    }
  }
  Vector<double> cos, sin;
};

/// Smoothed noise: modes times 1 / q^2, q = 10 m / box, summed as they are
/// (the samples are few, and their bits must not depend on an FFT).
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

/// What is kept of a block: a column for every register of samples; the second
/// of two blocks that share one has its half.
template <class T, class States>
auto* kept_of(States& states, const SampleBlock& block) {
  constexpr Index W = kLanes<T>;
  const Index half = block.first % W > 0 ? states.rows() / 2 : 0;
  return states.col(block.first / W).data() + half;
}

/// Cotangents of a block's unknowns and initial states.
template <class T, class K, class P>
void pull_block(const KuramotoSivashinskyOptions& o,
                const Block<K, P>& block,
                const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T>& x_bar,
                BatchOut<T>* given_bar,
                Workspace& work) {
  const auto x = tape.view<T>(kUnknowns);
  const auto states = tape.view<T>(kStates);
  const K& k = block.k;
  const Keeping keep(o, k, x.cols(), sizeof(T));
  const Index n = k.field(), h = k.stride();
  P* const lambda = take_packs<P>(work, n);
  P* const sum = take_packs<P>(work, 2 * h);
  const auto r = block.run(x, take_packs<P>(work, 3 * h));
  const Etdrk2Sums<P> sums{sum, sum + h};
  std::fill_n(sum, 2 * h, P{});
  block.load(y_bar, lambda);
  k.begin(r, lambda);
  const T* const kept = kept_of<T>(states, block);
  pull_steps(k, r, sums, o.steps, keep, reinterpret_cast<const P*>(kept), work);
  const P alpha_bar = k.alpha_bar(sums), beta_bar = k.beta_bar(sums);
  if (given_bar != nullptr) k.restore(r, lambda);
  for (Index i = 0; i < block.count; ++i) {
    x_bar(0, block.first + i) = alpha_bar[i * K::kSide];
    x_bar(1, block.first + i) = beta_bar[i * K::kSide];
    if (given_bar != nullptr)
      block.store(lambda, i, given_bar->col(block.first + i));
  }
}

template <class T>
class KuramotoSivashinsky final : public Problem<T>,
                                  public Vjp<T>,
                                  public Jacobian<T>,
                                  public StatePullback<T> {
 public:
  explicit KuramotoSivashinsky(const KuramotoSivashinskyOptions& o)
      : options_(o) {
    check_numbers<T>({{"box", o.box},
                      {"time_step", o.time_step},
                      {"prior_low", o.prior_low},
                      {"prior_high", o.prior_high},
                      {"start", o.start[0]},
                      {"start", o.start[1]}});
    SUITE_CHECK(o.tape_budget >= 0, "tape_budget must not be negative");
    SUITE_CHECK(o.cells >= 16 && (o.cells & (o.cells - 1)) == 0,
                "cells must be a power of two, at least 16");
    SUITE_CHECK(o.box > 0 && o.time_step > 0 && o.steps > 0,
                "box, time step and number of steps must be positive");
    SUITE_CHECK(o.prior_low <= o.prior_high,
                "prior_low must not exceed prior_high");
    circle_ = Circle(o.cells);
    kernels_ = std::make_unique<const Etdrk2Kernels<T>>(operators(o));
  }

  Shape shape() const override { return {2, options_.cells, options_.cells}; }
  Vector<double> start() const override {
    return Eigen::Vector2d(options_.start[0], options_.start[1]);
  }

  /// alpha, beta from the prior; u(0) is smoothed complex white noise (its
  /// amplitude falls as 1 / m^2; real part, mean 0, standard deviation 1).
  void draw(Stream& stream, SampleOut& sample) const override {
    for (Index j = 0; j < 2; ++j)
      sample.x(j) = stream.uniform(options_.prior_low, options_.prior_high);
    draw_state(options_, circle_, stream, sample.given);
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace& work) const override {
    const auto &x = at.x, &given = at.given;
    const Index steps = options_.steps;
    std::atomic<std::uint64_t> terms = 0;
    work.counts[Counter::skipped_steps] += sum_blocks(
        *kernels_,
        work,
        x.cols(),
        [&]<class K, class P>(const Block<K, P>& block, Workspace& mine) {
          const K& k = block.k;
          const Index n = k.field();
          P* const u = take_packs<P>(mine, 3 * n);
          const auto r = block.run(x, take_packs<P>(mine, 3 * k.stride()));
          const auto state = [=](Index t) { return u + t % 2 * n; };
          block.load(given, u);
          k.begin(r, u);
          Index end = steps;
          if (count_set(r.beta == P{}) == block.kWidth) {
            // Linear: the modes are independent.
            for (Index t = 0; t < steps; ++t) k.drift(r);
            k.restore(r, state(end));
            terms += static_cast<std::uint64_t>(2 * steps * block.count);
          } else {
            end =
                march(k, r, 0, steps, state, [=](Index) { return u + 2 * n; });
          }
          block.finish(state(end), y);
          terms += block.unforced(r, end);
          return (steps - end) * block.count;
        });
    work.counts[Counter::skipped_terms] += terms;
  }
  /// Keeps u and a of every step, or checkpoints (`tape_budget`).
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const auto &x = at.x, &given = at.given;
    constexpr Index W = kLanes<T>;
    const Index steps = options_.steps;
    const auto& lanes = kernels_->lanes;
    const Index most = Keeping(options_, lanes, x.cols(), sizeof(T)).rows;
    const Index threads =
        tape.threads() != nullptr ? tape.threads()->count() : 1;
    auto states = tape.slot<T>(kStates, most * W, (x.cols() + W - 1) / W);
    auto scratch = tape.slot<T>(
        kScratch, 3 * (lanes.stride() + lanes.field()) * W, threads);
    auto lost = tape.slot<unsigned char>(kLost, 1, x.cols());
    tape.slot<T>(kUnknowns, 2, x.cols()) = x;

    std::atomic<std::uint64_t> skipped = 0, terms = 0;
    const auto run = [&]<class K, class P>(const Block<K, P>& block,
                                           int thread) {
      const K& k = block.k;
      const Index n = k.field();
      const Keeping keep(options_, k, x.cols(), sizeof(T));
      P* const u = reinterpret_cast<P*>(scratch.col(thread).data());
      P* const kept = reinterpret_cast<P*>(kept_of<T>(states, block));
      const auto r = block.run(x, u + 3 * n);
      const bool all = keep.segment == 0;
      const auto state = [=](Index t) {
        return all ? kept + 2 * t * n : u + t % 2 * n;
      };
      const auto between = [=](Index t) {
        return all ? kept + (2 * t + 1) * n : u + 2 * n;
      };
      block.load(given, state(0));
      k.begin(r, state(0));
      Index end = 0, to = all ? steps : 0;
      while (end < steps) {
        if (!all) {
          P* const start = kept + end / keep.segment * keep.stride;
          std::copy_n(state(end), n, start);
          std::copy_n(r.s, k.stride(), start + n);
          to = std::min(steps, end + keep.segment);
        }
        end = march(k, r, end, to, state, between);
        if (all_lost<K::kSide>(state(end)[0])) break;
      }
      block.finish(state(end), y);
      for (Index i = 0; i < block.count; ++i)
        lost(0, block.first + i) = !std::isfinite(y(0, block.first + i));
      skipped += static_cast<std::uint64_t>((steps - end) * block.count);
      terms += block.unforced(r, end);
    };
    for_packs(*kernels_, tape.threads(), x.cols(), run);
    tape.counts[Counter::skipped_steps] += skipped;
    tape.counts[Counter::skipped_terms] += terms;
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    pull(tape, y_bar, x_bar, nullptr, work);
  }
  void pullback_state(const Tape& tape,
                      BatchIn<T> y_bar,
                      BatchOut<T> x_bar,
                      BatchOut<T> given_bar,
                      Workspace& work) const override {
    check_size(given_bar, options_.cells, y_bar.cols());
    pull(tape, y_bar, x_bar, &given_bar, work);
  }
  /// Column i: d u(end) / d alpha, then d u(end) / d beta.
  void jacobian(Point<T> at, BatchOut<T> j, Workspace& work) const override {
    const auto &x = at.x, &given = at.given;
    const Index cells = options_.cells, steps = options_.steps;
    std::atomic<std::uint64_t> terms = 0;
    work.counts[Counter::skipped_steps] += sum_blocks(
        *kernels_,
        work,
        x.cols(),
        [&]<class K, class P>(const Block<K, P>& block, Workspace& mine) {
          const K& k = block.k;
          const Index n = k.field(), h = k.stride();
          P* const u = take_packs<P>(mine, 3 * n);
          P* const d = take_packs<P>(mine, 6 * h);
          const auto r = block.run(x, take_packs<P>(mine, 3 * h));
          const Etdrk2Tangent<P> by_alpha{d, d + h, d + 2 * h},
              by_beta{d + 3 * h, d + 4 * h, d + 5 * h};
          std::fill_n(d, 6 * h, P{});
          block.load(given, u);
          k.begin(r, u);
          Index end = 0;
          bool finite = true;
          while (end < steps && finite) {
            const P* const now = u + end % 2 * n;
            P* const next = u + ++end % 2 * n;
            k.step(r, now, u + 2 * n, next);
            k.tangent_step(r, now, u + 2 * n, by_alpha, by_beta);
            finite = !all_lost<K::kSide>(next[0]);
          }
          auto y = mine.take<T>(cells, 1);
          for (Index i = 0; i < block.count; ++i) {
            auto column = j.col(block.first + i);
            block.store(by_alpha.du, i, column.head(cells));
            block.store(by_beta.du, i, column.tail(cells));
            block.store(u + end % 2 * n, i, y.col(0));
            if (!y.allFinite()) column.setConstant(kNan<T>);
          }
          terms += block.unforced(r, end);
          return (steps - end) * block.count;
        });
    work.counts[Counter::skipped_terms] += terms;
  }

  /// As many as keep their states in half a megabyte of cache, or nearly so.
  Index gradient_block() const override {
    const auto bytes =
        2 * options_.steps * options_.cells * static_cast<Index>(sizeof(T));
    constexpr Index W = kLanes<T>;
    return std::max<Index>(1, (Index{1} << 19) / bytes / W) * W;
  }

  double operations() const override {
    const double n = double(options_.cells);
    return double(options_.steps) * n * (4 * 2.5 * math::log2(n) + 12);
  }

 private:
  void pull(const Tape& tape,
            BatchIn<T> y_bar,
            BatchOut<T>& x_bar,
            BatchOut<T>* given_bar,
            Workspace& work) const {
    const auto x = tape.view<T>(kUnknowns);
    const auto lost = tape.view<unsigned char>(kLost);

    // What is lost ends as NaN whatever is done, zeros remain zeros. A block of
    // nothing else needs no way back; how many share one is the register's
    // affair, so that the count is of samples.
    const auto known = [&](Index i) {
      return lost(0, i) != 0 || (y_bar.col(i).array() == 0).all();
    };
    const auto finish = [&](Index i) {
      const T end = lost(0, i) != 0 ? kNan<T> : T(0);
      x_bar.col(i).setConstant(end);
      if (given_bar != nullptr) given_bar->col(i).setConstant(end);
    };
    work.counts[Counter::skipped_vjp] += sum_blocks(
        *kernels_, work, x.cols(), [&](const auto& block, Workspace& mine) {
          Index live = 0;
          for (Index i = 0; i < block.count; ++i)
            live += !known(block.first + i);
          if (live > 0)
            pull_block<T>(options_, block, tape, y_bar, x_bar, given_bar, mine);
          for (Index i = block.first; i < block.first + block.count; ++i)
            if (known(i)) finish(i);
          return block.count - live;
        });
  }

  KuramotoSivashinskyOptions options_;
  Circle circle_{0};
  std::unique_ptr<const Etdrk2Kernels<T>> kernels_;
};

}  // namespace

template <class T>
Batch<T> kuramoto_sivashinsky_trajectory(
    const KuramotoSivashinskyOptions& options,
    VectorIn<T> x,
    VectorIn<T> given) {
  const Index cells = options.cells, steps = options.steps;
  const Etdrk2Kernels<T> kernels(operators(options));
  check_size(x, 2, 1);
  check_size(given, cells, 1);
  Workspace work;
  Batch<T> out(cells, steps + 1);
  with_pack(kernels, 1, [&]<class K, class P>(const K& k, P) {
    const Block<K, P> block{{0, 1}, k};
    const Index n = k.field();
    P* const u = take_packs<P>(work, (steps + 2) * n);  // and the middle stage
    const auto r = block.run(x, take_packs<P>(work, 3 * k.stride()));
    const auto state = [=](Index t) { return u + t * n; };
    block.load(given, u);
    k.begin(r, u);
    const Index end = march(
        k, r, 0, steps, state, [=](Index) { return u + (steps + 1) * n; });
    for (Index t = 0; t <= end; ++t) block.store(state(t), 0, out.col(t));
    if (!out.col(end).allFinite())
      out.middleCols(end, steps + 1 - end).setConstant(kNan<T>);
  });
  return out;
}

template decltype(kuramoto_sivashinsky_trajectory<float>)
    kuramoto_sivashinsky_trajectory<float>;
template decltype(kuramoto_sivashinsky_trajectory<double>)
    kuramoto_sivashinsky_trajectory<double>;

ProblemRecipe problems::kuramoto_sivashinsky(
    const KuramotoSivashinskyOptions& options) {
  return problem<KuramotoSivashinsky>("kuramoto_sivashinsky",
                                      options,
                                      {.unknowns = {"alpha, beta"},
                                       .observations = {"u at the end(cell)"},
                                       .given = {"u at the start(cell)"}});
}

}  // namespace physinv
