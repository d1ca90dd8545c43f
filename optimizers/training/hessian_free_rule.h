/// Hessian-free optimization (Martens 2010) with Gauss and Newton's matrix G of
/// the batch, as the SIP paper's authors use it. An update, f the objective of
/// the batch and g its gradient at the parameters:
///
///  1. (G + damping I) s = -g by conjugate gradients, from 0.95 times where the
///     last update's ended;
///  2. rho = (f(s) - f(s_0)) / (m(s) - m(s_0)), m the model, s_0 the start;
///     damping grows by 1.5 if rho < 1/4, shrinks by as much if rho > 3/4;
///  3. back through the stored iterates while f falls;
///  4. along the best one, s: alpha = 1, 0.8, .., up to 20 trials, until
///     f(alpha s) <= f(0) + 0.01 alpha g.s; else no update.
///
/// Vectors of parameters are summed and kept in double. Leaves per update
/// `cg_iterations`, `damping` (as used), `rho`, `chosen` (iterate), `alpha`,
/// `objective` (before), `objective_after`.
#pragma once

#include <vector>

#include "optimizers/training/hessian_free.h"
#include "optimizers/training/rule.h"
#include "suite/core/check.h"

namespace physinv {

/// What happened in an update.
struct HessianFreeReport {
  std::vector<double> model;  ///< m_0, m_1, ..
  double damping = 0, next_damping = 0, rho = 0, alpha = 0;
  double before = 0, after = 0;  ///< the objective
  Index chosen = 0;
  std::vector<Index> stored;  ///< iterates

  void serialize(Archive& archive) {
    archive(model, damping, next_damping, rho, alpha, before, after);
    archive(chosen, stored);
  }
};

template <class T>
class HessianFreeRule final : public Rule<T> {
 public:
  HessianFreeRule(const HessianFreeOptions& options, NetworkModel<T>& model)
      : options_(options), model_(model), damping_(options.damping) {}

  /// False if objective or gradient are not finite, or what follows from them.
  bool operator()(Signal<T>& signal) override;
  void serialize(Archive& archive) override {
    archive(damping_, start_, reports_, stored_);
    SUITE_CHECK(
        start_.size() == 0 || start_.size() == model_.parameters().size(),
        "the checkpoint belongs to another network");
  }
  void export_to(Outcome& out) const override;
  std::size_t bytes() const override;

  const std::vector<HessianFreeReport>& reports() const { return reports_; }

 private:
  ConjugateGradientPath solve(Signal<T>& signal, const Vector<double>& g);
  /// f at theta + s, theta being where the update began.
  double at(Signal<T>& signal, const Vector<double>& s, double alpha);

  HessianFreeOptions options_;
  NetworkModel<T>& model_;
  double damping_;
  Vector<double> start_;  ///< what the last solve ended with
  Vector<T> theta_, direction_, product_;
  std::vector<HessianFreeReport> reports_;
  std::size_t stored_ = 0;  ///< numbers, at most
};

extern template class HessianFreeRule<float>;
extern template class HessianFreeRule<double>;

}  // namespace physinv
