/// The problems of one case as a method may see them: shapes checked, calls
/// counted, true solutions hidden, labels only for methods that asked.
#pragma once

#include <memory>
#include <span>

#include "suite/core/archive.h"
#include "suite/core/counted_problem.h"
#include "suite/core/problem.h"
#include "suite/core/recipe.h"

namespace physinv {

class Oracle {
 public:
  /// `labelled` is given only if `allowed` has labels.
  Oracle(const ProblemRecipe& recipe,
         Index count,
         const Rng& data,
         Needs allowed,
         Threads* threads = nullptr);
  ~Oracle();

  Shape shape() const { return shape_; }
  Index count() const { return data_.count(); }

  /// Start of the classical optimizers, one column per problem.
  Batch<double> start() const;
  const Batch<double>& given() const { return data_.given; }
  const Batch<double>& observations() const { return data_.y; }

  /// Loss of x(:, j) on problem active[j], in the precision of x.
  template <class T>
  void evaluate(std::span<const Index> active,
                BatchIn<T> x,
                VectorOut<double> loss);
  /// The same with gradients d loss / d x.
  template <class T>
  void evaluate(std::span<const Index> active,
                BatchIn<T> x,
                VectorOut<double> loss,
                BatchOut<T> gradient);

  /// Makes what the first evaluation in T would make: problem, data, buffers.
  /// Leaves no count behind.
  template <class T>
  void warm_up();

  /// Every problem at once: active = 0, 1, .. count-1.
  std::span<const Index> all() const { return all_; }

  /// Labelled samples from a separate set, so many for each problem; drawn on
  /// first use.
  const Samples<double>& labelled(Index per_problem = 1);
  /// Samples first .. first+count-1 of that set.
  Samples<double> labelled(Index first, Index count) const;

  /// Problems first .. first+count-1 of the same separate set, without their
  /// solutions: for methods that learn from the physics.
  Samples<double> training(Index first, Index count) const;

  /// The problem in the precision T, to be run anywhere and on any data. The
  /// caller adds its counts.
  template <class T>
  CountedProblem<T> problem() const;
  /// Was that, or a sibling, asked for? Then `counts` lacks what was not added
  /// yet.
  bool handed_out() const { return handed_out_; }
  /// Other problems of the same kind and configuration, from another stream.
  Oracle sibling(Index count, const Rng& data, Needs allowed) const;

  /// The problem for metrics and other observers: what it is, and runs
  /// that are not part of a method's work. Not counted.
  const Problem<double>& inspect() const { return *problem_; }

  /// Losses in double for curves and records; not counted, not part of a
  /// method's work.
  void measure(BatchIn<double> x, VectorOut<double> loss);
  /// The same, with the observations y(x) that the losses are of.
  void measure(BatchIn<double> x, BatchOut<double> y, VectorOut<double> loss);

  const Counts& counts() const;
  /// What was counted; everything else follows from the case.
  void serialize(Archive& archive) {
    counts();
    archive(counts_);
  }
  /// Adds counts a method keeps itself (network passes, work it skipped).
  void add(Counter counter, Index n);
  void add(const Counts& counts) { counts_ += counts; }
  /// Peak bytes of buffers held by the physics.
  std::size_t bytes() const;

  /// The data with the truth: for the harness and the record only.
  const Samples<double>& data() const { return data_; }
  double operations() const { return operations_; }

 private:
  template <class T>
  struct Side;
  template <class T>
  Side<T>& side();
  template <class T>
  struct Packed;

  ProblemRecipe recipe_;
  std::unique_ptr<const Problem<double>> problem_;
  Rng rng_;
  Needs allowed_;
  Shape shape_;
  Samples<double> data_, labelled_;
  std::vector<Index> all_;
  std::unique_ptr<Side<float>> float_;
  std::unique_ptr<Side<double>> double_;
  std::unique_ptr<Workspace> work_, measuring_;
  mutable Counts counts_;
  mutable bool handed_out_ = false;
  double operations_ = 0;
};

}  // namespace physinv
