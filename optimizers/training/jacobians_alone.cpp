#include "optimizers/training/jacobians_alone.h"

#include <memory>

#include "optimizers/training/signal.h"
#include "optimizers/training/solver_loss.h"

namespace physinv {
namespace {

template <class T>
class JacobiansAlone final : public Signal<T> {
 public:
  explicit JacobiansAlone(const SignalPlace<T>& place)
      : of_(solver_loss().make<T>(place)),
        zero_(Vector<T>::Zero(place.model.parameters().size())) {}

  void warm_up() override { of_->warm_up(); }
  bool evaluate(bool last) override { return of_->evaluate(last); }
  Vector<T>& gradient() override {
    of_->jacobians();
    zero_.setZero();
    return zero_;
  }
  void serialize(Archive& archive) override { of_->serialize(archive); }
  void export_to(Outcome& out) const override { of_->export_to(out); }
  Counts counts() const override { return of_->counts(); }
  std::size_t bytes() const override { return of_->bytes(); }

 private:
  std::unique_ptr<Signal<T>> of_;
  Vector<T> zero_;
};

}  // namespace

SignalRecipe jacobians_alone() {
  return batch_signal<JacobiansAlone>(
      "jacobians", Needs::jacobian, Needs::jacobian);
}

}  // namespace physinv
