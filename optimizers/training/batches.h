/// Which samples an update sees, when it does not see all: consecutive slices
/// of a training set, in the same order every epoch, or
/// fresh samples for every update, which are drawn while the clock is stopped.
/// Nothing allocates after the first batch, unless every batch is drawn afresh.
#pragma once

#include "suite/core/check.h"
#include "suite/core/method.h"

namespace physinv {

struct BatchOptions {
  Index size = 128;
  bool fresh = false;
  Index set = 0;  ///< samples of the training set, 0: as many as the case has
};

template <class T>
class Batches {
 public:
  /// Slices of `size` problems out of the set (`size` is cut to its number, a
  /// remainder is left out); with `fresh`, new problems from
  /// number `drawn` on for every batch.
  Batches(StageRun& run, const BatchOptions& options, Index drawn);

  void next();
  void keep_exact();
  /// From now on labelled samples, with their solutions.
  void keep_labels();

  /// Which batch is next; the samples follow from the case.
  void serialize(Archive& archive) {
    archive(drawn_, at_);
    SUITE_CHECK(drawn_ >= 0 && at_ >= 0 && (fresh_ || at_ < slices_),
                "the checkpoint belongs to other batches");
  }

  Index size() const { return size_; }
  /// Problems used so far, those of earlier stages included.
  Index drawn() const { return drawn_; }

  /// Samples first .. first+count-1 of the batch: what the network reads, what
  /// the problem is given, what was observed.
  auto input(Index first, Index count) const {
    return input_.middleCols(first_ + first, count);
  }
  auto given(Index first, Index count) const {
    return given_.middleCols(first_ + first, count);
  }
  auto target(Index first, Index count) const {
    return target_.middleCols(first_ + first, count);
  }

  /// The solutions, if they were kept.
  auto label(Index first, Index count) const {
    return label_.middleCols(first_ + first, count);
  }

  /// The observations before they were rounded, if they were kept.
  auto exact_target(Index first, Index count) const {
    return exact_target_.middleCols(first_ + first, count);
  }

  /// Of one batch: the set itself belongs to the problem.
  std::size_t bytes() const;

 private:
  void load(Index first, Index count);

  StageRun& run_;
  Index size_, slices_, drawn_, at_ = 0;
  bool fresh_, exact_ = false, labelled_ = false;
  /// All slices, or a fresh batch; the current one starts at column `first_`.
  Batch<T> target_, given_, input_, label_;
  Batch<double> exact_target_;
  Index first_ = 0;
};

/// Samples that the stages before have used.
Index drawn_before(const StageRun& run);

extern template class Batches<float>;
extern template class Batches<double>;

}  // namespace physinv
