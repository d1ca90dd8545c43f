#include "optimizers/training/solver_loss.h"

#include "optimizers/training/batch_signal.h"
#include "suite/core/oracle.h"

namespace physinv {
namespace {

template <class T>
class SolverLoss final : public BatchSignal<T> {
 public:
  explicit SolverLoss(const SignalPlace<T>& place)
      : BatchSignal<T>(place),
        problem_(place.run.oracle.recipe().template make<T>()),
        vjp_(dynamic_cast<const Vjp<T>*>(problem_.get())),
        jvp_(dynamic_cast<const Jvp<T>*>(problem_.get())),
        tangent_(dynamic_cast<const PullbackTangent<T>*>(problem_.get())),
        jacobian_(dynamic_cast<const Jacobian<T>*>(problem_.get())),
        projection_(dynamic_cast<const GradientProjection<T>*>(problem_.get())),
        y_(place.run.oracle.shape().observations, this->batches_.size()),
        y_bar_(y_),
        tape_(place.run.threads),
        work_(place.run.threads) {}

  Jacobians<T> jacobians() override {
    const Index n = this->batches_.size();
    const Batch<T>& x = this->estimate(0, n);
    const auto given = this->batches_.given(0, n);
    problem_->forward(x, given, y_, work_);
    compare(0, this->loss_);
    if (this->options_.project && projection_ != nullptr)
      projection_->project(y_, y_bar_);
    solver_.resize(x.rows() * y_.rows(), n);
    jacobian_->jacobian(x, given, solver_, work_);
    counts_[Counter::jacobian] += static_cast<std::uint64_t>(n);
    this->map_->pull_back_rows(solver_);
    this->note_loss();
    return {solver_, y_bar_};
  }

  Counts counts() const override {
    Counts all = counts_;
    all += work_.counts;
    all += tape_.counts;
    return all;
  }
  std::size_t bytes() const override {
    const Index numbers =
        y_.size() + y_bar_.size() + y_dot_.size() + solver_.size();
    return BatchSignal<T>::bytes() +
           static_cast<std::size_t>(numbers) * sizeof(T) + tape_.bytes() +
           work_.bytes();
  }

 private:
  void push(BatchIn<T> x,
            Index first,
            VectorOut<double> loss,
            BatchOut<T> x_bar) override {
    const Index n = x.cols();
    vjp_->linearize(
        x, this->batches_.given(first, n), y_.middleCols(first, n), tape_);
    compare(first, loss);
    vjp_->pullback(tape_, y_bar_.middleCols(first, n), x_bar, work_);
    counts_[Counter::vjp] += static_cast<std::uint64_t>(n);
  }

  /// Such a problem's loss is half the squared error.
  void push_tangent(BatchIn<T> x_dot,
                    bool linear,
                    BatchOut<T> x_bar_dot) override {
    y_dot_.resizeLike(y_);
    jvp_->pushforward(tape_, x_dot, y_dot_, work_);
    y_dot_ *= this->factor_;
    if (linear) {
      vjp_->pullback(tape_, y_dot_, x_bar_dot, work_);
    } else {
      tangent_->pullback_tangent(
          tape_, x_dot, y_bar_, y_dot_, x_bar_dot, work_);
    }
    counts_[Counter::vjp] += static_cast<std::uint64_t>(x_dot.cols());
  }

  void weigh(BatchIn<T> x, VectorOut<double> loss) override {
    const Index n = x.cols();
    y_dot_.resizeLike(y_);
    problem_->forward(x, this->batches_.given(0, n), y_dot_, work_);
    problem_->loss(y_dot_, this->batches_.target(0, n), loss);
    counts_[Counter::forward] += static_cast<std::uint64_t>(n);
  }

  /// Losses at y, and y_bar = factor * d loss / d y.
  void compare(Index first, VectorOut<double> loss) {
    const Index n = loss.size();
    const auto y = y_.middleCols(first, n);
    const auto target = this->batches_.target(first, n);
    auto y_bar = y_bar_.middleCols(first, n);
    problem_->loss(y, target, loss);
    problem_->loss_gradient(y, target, y_bar);
    y_bar *= this->factor_;
  }

  std::unique_ptr<Problem<T>> problem_;
  const Vjp<T>* vjp_;
  const Jvp<T>* jvp_;
  const PullbackTangent<T>* tangent_;
  const Jacobian<T>* jacobian_;
  const GradientProjection<T>* projection_;
  Batch<T> y_, y_bar_, y_dot_, solver_;
  Tape tape_;
  Workspace work_;
  Counts counts_;
};

}  // namespace

SignalRecipe solver_loss() {
  SignalRecipe recipe =
      batch_signal<SolverLoss>("training", Needs::vjp, Needs::jacobian);
  recipe.gauss_newton = Needs::vjp | Needs::jvp;
  recipe.hessian = *recipe.gauss_newton | Needs::pullback_tangent;
  return recipe;
}

}  // namespace physinv
