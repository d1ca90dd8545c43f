/// Watches a running stage: counts iterations, keeps the clock and measures the
/// curve while the clock is stopped. What that takes, and what comes after the
/// end, is measuring.
///
///   while (probe.proceed([&](BatchOut<double> x) { predict(x); })) step();
#pragma once

#include <concepts>
#include <functional>
#include <vector>

#include "suite/core/archive.h"
#include "suite/core/clock.h"
#include "suite/core/curve.h"
#include "suite/core/hash.h"
#include "suite/core/nan.h"

namespace physinv {

class Oracle;

/// Sums the time between start and stop; starts stopped.
class Stopwatch {
 public:
  void start() {
    if (!running_) since_ = now();
    running_ = true;
  }
  void stop() {
    if (running_) total_ += now() - since_;
    running_ = false;
  }
  bool running() const { return running_; }
  /// What was restored counts too.
  void serialize(Archive& archive) {
    Seconds sum = total();
    archive(sum);
    if (archive.reading()) total_ += sum;
  }
  Seconds total() const {
    Seconds sum = total_;
    if (running_) sum += now() - since_;
    return sum;
  }

 private:
  Seconds since_, total_;
  bool running_ = false;
};

class Probe {
 public:
  /// Trace of a run for tests: called each iteration with bytes to hash.
  using Trace = std::function<void(const void* data, std::size_t bytes)>;

  /// `tracked` examples have their estimates stored along the curve.
  Probe(Oracle& oracle, Index iterations, Index tracked = 4);

  /// Ends set-up; what follows is a discarded pass that fills caches.
  void begin_warmup();
  /// Starts the solving clock (the first `proceed` does it too).
  void begin();

  /// True while iterations are left. When a point of the curve is due, stops
  /// the clock, asks `estimate` to fill x, measures its true loss and passes x
  /// and the observations y(x) to `measured`.
  template <class F, class G>
  bool proceed(F&& estimate, G&& measured) {
    if (!begun_) begin();
    if (due()) {
      const Aside aside = measuring();
      estimate(BatchOut<double>(x_));
      measure();
      measured(BatchIn<double>(x_), BatchIn<double>(y_));
    }
    if (iteration_ >= iterations_ || stopped_) {
      end();
      return false;
    }
    ++iteration_;
    return true;
  }
  template <class F>
  bool proceed(F&& estimate) {
    return proceed(estimate, [](BatchIn<double>, BatchIn<double>) {});
  }

  /// For solvers that advance example by example and know their losses:
  /// example i reached its iterate `iteration`. A point of the curve holds
  /// every example's iterate of that number, or its last one if it ended
  /// before; `finish` fills these in.
  void accept(Index example, Index iteration, const double* x, double loss);
  void finish();

  /// No more iterations: the next `proceed` measures and ends.
  void stop() { stopped_ = true; }
  bool stopped() const { return stopped_; }
  void end();

  /// Work that is not solving: during its lifetime another clock runs in place
  /// of the solving clock, or none. Before the beginning it is part of set-up.
  class Aside {
   public:
    Aside(Stopwatch& solve, Stopwatch* other)
        : solve_(solve.running() ? &solve : nullptr), other_(other) {
      if (solve_ == nullptr) return;
      solve_->stop();
      if (other_ != nullptr) other_->start();
    }
    ~Aside() {
      if (solve_ == nullptr) return;
      if (other_ != nullptr) other_->stop();
      solve_->start();
    }
    Aside(const Aside&) = delete;
    Aside& operator=(const Aside&) = delete;

   private:
    Stopwatch *solve_, *other_;
  };
  [[nodiscard]] Aside measuring() { return {solve_, &measure_}; }
  /// Training examples.
  [[nodiscard]] Aside drawing() { return {solve_, &data_}; }
  /// No part of the stage: its state is written down.
  [[nodiscard]] Aside recording() { return {solve_, nullptr}; }

  Index iteration() const { return iteration_; }
  Index iterations() const { return iterations_; }
  const Curve& curve();
  /// The losses of x, if they are what was measured last.
  bool knows_losses(BatchIn<double> x, VectorOut<double> loss) const;
  Clocks clocks() const;
  /// Not of solvers that run example by example.
  void serialize(Archive& archive);

  /// Called at every point of the curve, the clock stopped meanwhile.
  using Observer = std::function<void(Index iteration, VectorIn<double> loss)>;
  void set_observer(Observer observer) { observer_ = std::move(observer); }

  void set_trace(Trace trace) { trace_ = std::move(trace); }
  /// Hashes what is traced.
  void follow() { follows_ = true; }
  std::uint64_t trajectory() const { return trajectory_; }
  bool traced() const { return follows_ || trace_; }
  void trace(const void* data, std::size_t bytes) {
    if (follows_) trajectory_ = hash_bytes(data, bytes, trajectory_);
    if (trace_) trace_(data, bytes);
  }
  /// Every NaN as the same bits.
  template <std::floating_point T>
  void trace(const T* values, std::size_t bytes) {
    if (!traced()) return;
    const auto count = static_cast<Index>(bytes / sizeof(T));
    if (!has_nan(values, count))
      return trace(static_cast<const void*>(values), bytes);
    std::vector<T> unified(values, values + count);
    unify_nan(unified);
    trace(static_cast<const void*>(unified.data()), bytes);
  }

 private:
  bool due() const;
  void measure();
  void append(Index iteration, BatchIn<double> x, VectorIn<double> loss);
  Index open_point(Index iteration);
  void put(Index point, Index example, const double* x, double loss);

  Oracle& oracle_;
  Index iterations_, iteration_ = 0, next_ = 0, tracked_;
  bool begun_ = false, stopped_ = false, measured_ = false;
  Stopwatch setup_, warmup_, data_, solve_, measure_;
  Batch<double> x_, y_;
  Vector<double> loss_;
  std::vector<Index> reached_;  ///< points each example has, with `accept`
  Curve curve_;
  bool follows_ = false;
  std::uint64_t trajectory_ = hash_text("trajectory");
  Trace trace_;
  Observer observer_;
};

/// Examples whose paths curves keep: paths are looked at where there are few
/// unknowns.
constexpr Index tracked_examples(Index unknowns) {
  return unknowns <= 16 ? 4 : 1;
}

/// The iterations at which curves are measured: every one up to 14, then about
/// seventeen per factor of ten.
Index next_measured(Index iteration);

}  // namespace physinv
