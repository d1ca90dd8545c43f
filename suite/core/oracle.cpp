#include "suite/core/oracle.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "suite/core/blocks.h"
#include "suite/core/disturbance.h"
#include "suite/core/eigen_caches.h"
#include "suite/core/float_environment.h"

namespace physinv {
namespace {

/// Before the first product, and before threads.
[[maybe_unused]] const bool kBlocksFixed = [] {
  state_caches();
  return true;
}();

}  // namespace

/// The problem and its data in one precision, made when first asked for.
template <class T>
struct Oracle::Side {
  Side(const ProblemRecipe& recipe,
       const Samples<double>& data,
       Threads* threads)
      : problem(recipe.make<T>()),
        vjp(dynamic_cast<const Vjp<T>*>(problem.get())),
        given(data.given.template cast<T>()),
        y(data.y.template cast<T>()),
        tape(threads) {}

  std::unique_ptr<Problem<T>> problem;
  const Vjp<T>* vjp;
  Batch<T> given, y;
  Tape tape;
};

/// Data of the active problems: the full arrays, or copies of some columns.
template <class T>
struct Oracle::Packed {
  Packed(const Side<T>& side, std::span<const Index> active, Workspace& work)
      : all(is_all(active, side.y.cols())),
        given(work.take<T>(side.given.rows(), all ? 0 : size(active))),
        y(work.take<T>(side.y.rows(), all ? 0 : size(active))) {
    if (all) return;
    for (Index j = 0; j < size(active); ++j) {
      const Index i = active[static_cast<std::size_t>(j)];
      given.col(j) = side.given.col(i);
      y.col(j) = side.y.col(i);
    }
  }
  static bool is_all(std::span<const Index> active, Index count) {
    if (size(active) != count) return false;
    for (Index j = 0; j < count; ++j)
      if (active[static_cast<std::size_t>(j)] != j) return false;
    return true;
  }
  static Index size(std::span<const Index> active) {
    return static_cast<Index>(active.size());
  }
  Eigen::Ref<const Batch<T>> given_of(const Side<T>& side) const {
    if (all) return side.given;
    return given;
  }
  Eigen::Ref<const Batch<T>> y_of(const Side<T>& side) const {
    if (all) return side.y;
    return y;
  }
  bool all;
  Scratch<T> given, y;
};

Oracle::Oracle(const ProblemRecipe& recipe,
               Index count,
               const Rng& data,
               Needs allowed,
               Threads* threads)
    : recipe_(recipe),
      problem_(recipe_.make<double>()),
      rng_(data),
      allowed_(allowed),
      all_(static_cast<std::size_t>(count)),
      work_(std::make_unique<Workspace>(threads)),
      measuring_(std::make_unique<Workspace>(threads)) {
  SUITE_CHECK(count > 0, "a case must have at least one problem");
  shape_ = problem_->shape();
  operations_ = problem_->operations();
  data_ = disturbed(problem_->sample(0, count, rng_.child("data/test")));
  std::iota(all_.begin(), all_.end(), Index{0});
}

Oracle::~Oracle() = default;

template <>
Oracle::Side<float>& Oracle::side<float>() {
  if (!float_)
    float_ = std::make_unique<Side<float>>(recipe_, data_, work_->threads());
  return *float_;
}

template <>
Oracle::Side<double>& Oracle::side<double>() {
  if (!double_)
    double_ = std::make_unique<Side<double>>(recipe_, data_, work_->threads());
  return *double_;
}

Batch<double> Oracle::start() const {
  return problem_->start().replicate(1, count());
}

template <class T>
void Oracle::evaluate(std::span<const Index> active,
                      BatchIn<T> x,
                      VectorOut<double> loss) {
  Side<T>& s = side<T>();
  const Index m = Packed<T>::size(active);
  SUITE_CHECK(x.rows() == shape_.unknowns && x.cols() == m && loss.size() == m,
              "x and loss must match the active problems");
  Workspace::Scope scope(*work_);
  const Packed<T> data(s, active, *work_);
  auto y = work_->take<T>(shape_.observations, m);
  s.problem->forward({x, data.given_of(s)}, y, *work_);
  s.problem->loss(y, data.y_of(s), loss);
  add(Counter::forward, m);
}

template <class T>
void Oracle::evaluate(std::span<const Index> active,
                      BatchIn<T> x,
                      VectorOut<double> loss,
                      BatchOut<T> gradient) {
  Side<T>& s = side<T>();
  const Index m = Packed<T>::size(active);
  SUITE_CHECK(s.vjp != nullptr && contains(allowed_, Needs::vjp),
              "the method requested gradients without declaring them");
  SUITE_CHECK(x.rows() == shape_.unknowns && x.cols() == m &&
                  loss.size() == m && gradient.rows() == x.rows() &&
                  gradient.cols() == m,
              "x, loss and gradient must match the active problems");
  Workspace::Scope scope(*work_);
  const Packed<T> data(s, active, *work_);
  const auto given = data.given_of(s), target = data.y_of(s);
  // As many samples as stay in the caches of every thread: those of one thread
  // alone would leave the others without work. A sample's bits are its own.
  const Index wanted = s.problem->gradient_block() * count_of(work_->threads());
  const Index block = wanted > 0 ? std::min(wanted, m) : m;
  auto y = work_->take<T>(shape_.observations, block);
  auto y_bar = work_->take<T>(shape_.observations, block);
  for (Index first = 0; first < m; first += block) {
    const Index some = std::min(block, m - first);
    const auto part = [=](const auto& all) {
      return all.middleCols(first, some);
    };
    s.vjp->linearize({part(x), part(given)}, y.leftCols(some), s.tape);
    s.problem->loss(y.leftCols(some), part(target), loss.segment(first, some));
    s.problem->loss_gradient(
        y.leftCols(some), part(target), y_bar.leftCols(some));
    s.vjp->pullback(
        s.tape, y_bar.leftCols(some), gradient.middleCols(first, some), *work_);
  }
  add(Counter::vjp, m);
}

template void Oracle::evaluate(std::span<const Index>,
                               BatchIn<float>,
                               VectorOut<double>);
template void Oracle::evaluate(std::span<const Index>,
                               BatchIn<double>,
                               VectorOut<double>);
template void Oracle::evaluate(std::span<const Index>,
                               BatchIn<float>,
                               VectorOut<double>,
                               BatchOut<float>);
template void Oracle::evaluate(std::span<const Index>,
                               BatchIn<double>,
                               VectorOut<double>,
                               BatchOut<double>);

template <class T>
void Oracle::warm_up() {
  const Counts before = counts();
  const Batch<T> x = start().template cast<T>();
  Batch<T> gradient(x.rows(), x.cols());
  Vector<double> loss(count());
  if (side<T>().vjp != nullptr && contains(allowed_, Needs::vjp)) {
    evaluate<T>(all_, x, loss, gradient);
  } else {
    evaluate<T>(all_, x, loss);
  }
  static_cast<void>(counts());
  counts_ = before;
}

template void Oracle::warm_up<float>();
template void Oracle::warm_up<double>();

const Samples<double>& Oracle::labelled(Index per_problem) {
  if (labelled_.count() != per_problem * count())
    labelled_ = labelled(0, per_problem * count());
  return labelled_;
}

Samples<double> Oracle::labelled(Index first, Index count) const {
  SUITE_CHECK(contains(allowed_, Needs::labels),
              "the method requested labels without declaring them");
  return disturbed(
      problem_->sample_labelled(first, count, rng_.child("data/train")));
}

Samples<double> Oracle::training(Index first, Index count) const {
  Samples<double> drawn =
      disturbed(problem_->sample(first, count, rng_.child("data/train")));
  drawn.x.resize(0, count);
  return drawn;
}

template <class T>
CountedProblem<T> Oracle::problem() const {
  handed_out_ = true;
  return {recipe_.make<T>(), allowed_, work_->threads()};
}

template CountedProblem<float> Oracle::problem() const;
template CountedProblem<double> Oracle::problem() const;

Oracle Oracle::sibling(Index count, const Rng& data, Needs allowed) const {
  handed_out_ = true;
  return {recipe_, count, data, allowed, work_->threads()};
}

void Oracle::measure(BatchIn<double> x, VectorOut<double> loss) {
  Workspace::Scope scope(*measuring_);
  auto y = measuring_->take<double>(shape_.observations, count());
  measure(x, y, loss);
}

void Oracle::measure(BatchIn<double> x,
                     BatchOut<double> y,
                     VectorOut<double> loss) {
  const DefaultFloatEnvironment floats;  // whatever the method has
  Side<double>& s = side<double>();
  Workspace::Scope scope(*measuring_);
  s.problem->forward({x, s.given}, y, *measuring_);
  s.problem->loss(y, s.y, loss);
}

const Counts& Oracle::counts() const {
  counts_ += std::exchange(work_->counts, {});
  if (float_) counts_ += std::exchange(float_->tape.counts, {});
  if (double_) counts_ += std::exchange(double_->tape.counts, {});
  return counts_;
}

void Oracle::add(Counter counter, Index n) {
  counts_[counter] += static_cast<std::uint64_t>(n);
}

std::size_t Oracle::bytes() const {
  std::size_t sum = work_->bytes();
  if (float_) sum += float_->tape.bytes();
  if (double_) sum += double_->tape.bytes();
  return sum;
}

}  // namespace physinv
