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
        problem_(place.run.oracle.template problem<T>()),
        y_(place.run.oracle.shape().observations, this->batches_.size()),
        y_bar_(y_) {}

  Jacobians<T> jacobians() override {
    const Index n = this->batches_.size();
    const Batch<T>& x = this->estimate(0, n);
    const auto given = this->batches_.given(0, n);
    solver_.resize(x.rows() * y_.rows(), n);
    problem_.jacobian(x, given, y_, solver_);
    compare(0, this->loss_);
    if (this->options_.project) problem_.project(y_, y_bar_);
    this->map_->pull_back_rows(solver_);
    this->note_loss();
    return {solver_, y_bar_};
  }

  Counts counts() const override { return problem_.counts(); }
  std::size_t bytes() const override {
    const Index numbers =
        y_.size() + y_bar_.size() + y_dot_.size() + solver_.size();
    return BatchSignal<T>::bytes() +
           static_cast<std::size_t>(numbers) * sizeof(T) + problem_.bytes();
  }

 private:
  void push(BatchIn<T> x,
            Index first,
            VectorOut<double> loss,
            BatchOut<T> x_bar) override {
    const Index n = x.cols();
    problem_.linearize(
        x, this->batches_.given(first, n), y_.middleCols(first, n));
    compare(first, loss);
    problem_.pullback(y_bar_.middleCols(first, n), x_bar);
  }

  /// Such a problem's loss is half the squared error.
  void push_tangent(BatchIn<T> x_dot,
                    bool linear,
                    BatchOut<T> x_bar_dot) override {
    y_dot_.resizeLike(y_);
    problem_.pushforward(x_dot, y_dot_);
    y_dot_ *= this->factor_;
    if (linear) {
      problem_.pullback(y_dot_, x_bar_dot);
    } else {
      problem_.pullback_tangent(x_dot, y_bar_, y_dot_, x_bar_dot);
    }
  }

  void weigh(BatchIn<T> x, VectorOut<double> loss) override {
    const Index n = x.cols();
    y_dot_.resizeLike(y_);
    problem_.forward(x, this->batches_.given(0, n), y_dot_);
    problem_.loss(y_dot_, this->batches_.target(0, n), loss);
  }

  /// Losses at y, and y_bar = factor * d loss / d y.
  void compare(Index first, VectorOut<double> loss) {
    const Index n = loss.size();
    const auto y = y_.middleCols(first, n);
    const auto target = this->batches_.target(first, n);
    auto y_bar = y_bar_.middleCols(first, n);
    problem_.loss(y, target, loss);
    problem_.loss_gradient(y, target, y_bar);
    y_bar *= this->factor_;
  }

  CountedProblem<T> problem_;
  Batch<T> y_, y_bar_, y_dot_, solver_;
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
