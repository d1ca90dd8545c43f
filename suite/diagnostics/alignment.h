/// Measures how often gradients, and the updates of a network trained with
/// them, point at the solution (JPO paper, Secs. 2-3, Fig. 2).
///
/// A repetition draws new n problems of the case, and a new network if there is
/// one; its data depend on the case's seed, n and its own number only, so few
/// repetitions are a prefix of many. Without a network, all problems share one
/// x ~ U(-1, 1) and the question is whether the sum of their gradients, or the
/// majority of their signs, has the sign of x - x* (tie: 1/2). With one, x_i
/// are its predictions and the question is for what share of the examples one
/// step (one_step.h) moves x_i towards x*_i.
///
/// Stage `measure`; its iterations are the repetitions. Arrays left
/// (repetitions x 1, shares aligned): `sum` and `vote` of the same data, and
/// with a network `noise_free`, the step without noise; without noise only
/// that; where gradients are clipped, `clipped`, of the sum of gradients whose
/// absolute value goes no further than the threshold. The estimate stays at the
/// start: nothing is solved.
#pragma once

#include <optional>
#include <vector>

#include "suite/core/method.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/core/simd/math.h"
#include "suite/core/threads.h"
#include "suite/diagnostics/one_step.h"

namespace physinv {

/// Noise<T>: problems in lanes, as problems/noisy_absolute/noise_lanes.h.
template <template <class> class Noise>
struct AlignmentOptions {
  typename Noise<double>::Options data;
  std::optional<TinyNetOptions> network;
  Index repetitions = 1000;
  /// Threshold of single gradients, without a network.
  std::optional<double> clip = {};

  auto fields() const {
    return std::tuple{word("algorithm", "diagnostic"),
                      word("measures", "alignment"),
                      field("data", data),
                      field("network", network),
                      field("clip", clip),
                      implied(repetitions)};
  }
};

/// One block of lanes of repetitions, and its scratch.
template <class T, template <class> class Noise>
class AlignmentBlock {
 public:
  using P = Pack<T>;

  AlignmentBlock(const AlignmentOptions<Noise>& options, Index n)
      : noise_(options.data),
        noisy_(options.data.terms > 0),
        clips_(options.clip.has_value()),
        clip_(static_cast<T>(options.clip.value_or(0)) - P{}),
        n_(n) {
    if (options.network) network_ = one_step<T>(*options.network);
    const auto room = static_cast<std::size_t>(n) * sizeof(P);
    for (Buffer* b : {&gamma_, &x_, &sign_, &lambda_, &level_, &g_, &delta_})
      b->reserve(room);
  }

  struct Shares {
    P sum{}, vote{}, noise_free{}, clipped{};
  };

  Shares run(StreamLanes<T> random) {
    return network_ ? step(random) : known(random);
  }

  Index passes() const { return network_ ? network_->passes(n_) : 0; }
  Index steps() const { return network_ ? (noisy_ ? 3 : 1) : 0; }

 private:
  static P* packs(const Buffer& b) { return static_cast<P*>(b.data()); }

  Shares known(StreamLanes<T>& random) {
    const P x = random.uniform(T(-1), T(1));
    P sum{}, votes{}, clipped{};
    for (Index i = 0; i < n_; ++i) {
      const auto p = noise_.draw(random);
      const P s = sign_lanes(x - p.solution);
      const P g = s * (p.lambda * s + noise_.noise(random, p.level));
      sum += g;
      votes += sign_lanes(g);
      if (clips_) clipped += clip(g);
    }
    const P half = T(0.5) - P{};
    Shares out;
    out.sum = half + half * sign_lanes(sum);
    out.vote = half + half * sign_lanes(votes);
    out.clipped = half + half * sign_lanes(clipped);
    return out;
  }

  P clip(P g) const {
    const P below = select(g > clip_, clip_, g);
    return select(below < -clip_, -clip_, below);
  }

  Shares step(StreamLanes<T>& random) {
    network_->initialize(random);
    P *gamma = packs(gamma_), *x = packs(x_), *s = packs(sign_);
    P *lambda = packs(lambda_), *level = packs(level_), *g = packs(g_);
    for (Index i = 0; i < n_; ++i) {
      const auto p = noise_.draw(random);
      gamma[i] = p.gamma, s[i] = p.solution;
      lambda[i] = p.lambda, level[i] = p.level;
    }
    network_->predict(gamma, n_, x);
    for (Index i = 0; i < n_; ++i) {
      s[i] = sign_lanes(x[i] - s[i]);
      g[i] = lambda[i] * s[i];
    }
    Shares out;
    out.noise_free = aligned();
    if (!noisy_) return out;
    for (Index i = 0; i < n_; ++i) g[i] += noise_.noise(random, level[i]);
    out.sum = aligned();
    for (Index i = 0; i < n_; ++i) g[i] = sign_lanes(g[i]);
    out.vote = aligned();
    return out;
  }

  /// Share of examples that the step along g_ moves against their sign.
  P aligned() {
    P *delta = packs(delta_), *s = packs(sign_);
    network_->respond(packs(g_), delta);
    const P one = 1 - P{};
    P count{};
    for (Index i = 0; i < n_; ++i)
      count += select(delta[i] * s[i] < P{}, one, P{});
    return count / static_cast<T>(n_);
  }

  Noise<T> noise_;
  bool noisy_, clips_;
  P clip_;
  Index n_;
  std::unique_ptr<OneStep<T>> network_;
  Buffer gamma_, x_, sign_, lambda_, level_, g_, delta_;
};

template <template <class> class Noise>
class MeasureAlignment final : public Stage {
 public:
  explicit MeasureAlignment(AlignmentOptions<Noise> options)
      : options_(std::move(options)) {}

  std::string name() const override { return "measure"; }
  Needs needs() const override { return Needs::forward | Needs::vjp; }
  Options options() const override { return describe(options_); }
  Index default_iterations() const override { return options_.repetitions; }
  bool has_precision() const override { return true; }
  Networks networks() const override { return Networks::none; }
  Sources sources() const override {
    Sources all = Stage::sources();
    all.roots.emplace_back(Noise<double>::kSource);
    return all;
  }
  double operations(const CaseSize& size) const override {
    double each = 50.0 * static_cast<double>(options_.data.terms + 1);
    if (options_.network) {
      Index in = 1, weights = 0;
      for (const Index out : options_.network->hidden)
        weights += in * out, in = out;
      each += 8.0 * static_cast<double>(weights);
    }
    return each * static_cast<double>(size.n * size.iterations);
  }
  Outcome run(StageRun& run) const override {
    return run.precision == Precision::f32 ? measure<float>(run)
                                           : measure<double>(run);
  }

 private:
  template <class T>
  Outcome measure(StageRun& run) const {
    using Block = AlignmentBlock<T, Noise>;
    constexpr Index kWidth = kLanes<T>;
    const Index n = run.oracle.count(), repetitions = run.iterations;
    const Rng rng = run.batches.child(static_cast<std::uint64_t>(n));
    std::vector<Block> scratch;
    for (int t = 0; t < (run.threads ? run.threads->count() : 1); ++t)
      scratch.emplace_back(options_, n);
    Outcome out;
    out.x = run.oracle.start();
    const bool noisy = options_.data.terms > 0;
    const auto array = [&](ArrayKey name, bool wanted) -> double* {
      if (!wanted) return nullptr;
      return (out.arrays[name] = Batch<double>(repetitions, 1)).data();
    };
    double* sum = array("sum", noisy);
    double* vote = array("vote", noisy);
    double* noise_free = array("noise_free", options_.network.has_value());
    double* clipped = array("clipped", options_.clip.has_value());
    Vector<double> loss(n);
    run.oracle.measure(out.x, loss);

    run.probe.begin();
    accept(run, out.x, loss, 0);
    const Index blocks = (repetitions + kWidth - 1) / kWidth;
    for_blocks(run.threads, blocks, [&](Index block, int thread) {
      const Index first = block * kWidth;
      const auto shares = scratch[static_cast<std::size_t>(thread)].run(
          StreamLanes<T>([&](int k) {
            return rng.child(static_cast<std::uint64_t>(first + k)).stream();
          }));
      for (Index k = 0; k < std::min(kWidth, repetitions - first); ++k) {
        if (sum) sum[first + k] = static_cast<double>(shares.sum[k]);
        if (vote) vote[first + k] = static_cast<double>(shares.vote[k]);
        if (clipped)
          clipped[first + k] = static_cast<double>(shares.clipped[k]);
        if (noise_free)
          noise_free[first + k] = static_cast<double>(shares.noise_free[k]);
      }
    });
    if (repetitions > 0) accept(run, out.x, loss, repetitions);
    run.probe.finish();

    for (const auto& [name, values] : out.arrays)
      run.probe.trace(values.data(),
                      sizeof(double) * static_cast<std::size_t>(repetitions));
    run.oracle.add(Counter::vjp, repetitions * n);
    const Index passes = repetitions * scratch.front().passes();
    const Index steps = scratch.front().steps();
    run.oracle.add(Counter::network_forward, passes * (1 + steps));
    run.oracle.add(Counter::network_backward, passes * steps);
    out.iterations.setConstant(n, static_cast<double>(repetitions));
    out.evaluations.setConstant(n, static_cast<double>(repetitions));
    return out;
  }

  static void accept(StageRun& run,
                     const Batch<double>& x,
                     const Vector<double>& loss,
                     Index iteration) {
    for (Index i = 0; i < x.cols(); ++i)
      run.probe.accept(i, iteration, x.col(i).data(), loss(i));
  }

  AlignmentOptions<Noise> options_;
};

}  // namespace physinv
