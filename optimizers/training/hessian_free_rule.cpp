#include "optimizers/training/hessian_free_rule.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "optimizers/metrics.h"

namespace physinv {
namespace {

constexpr double kGrow = 1.5, kLow = 0.25, kHigh = 0.75;
constexpr double kShorter = 0.8, kDescent = 0.01;
constexpr int kTrials = 20;

}  // namespace

template <class T>
ConjugateGradientPath HessianFreeRule<T>::solve(Signal<T>& signal,
                                                const Vector<double>& g) {
  if (start_.size() == 0) start_.setZero(g.size());
  return conjugate_gradients(
      [&](const Vector<double>& d, Vector<double>& a_d) {
        direction_ = d.template cast<T>();
        signal.gauss_newton_product(direction_, product_);
        a_d = product_.template cast<double>();
        for (Index i = 0; i < d.size(); ++i)
          a_d(i) = std::fma(damping_, d(i), a_d(i));
      },
      -g,
      options_.warm * start_,
      options_.solver);
}

template <class T>
double HessianFreeRule<T>::at(Signal<T>& signal,
                              const Vector<double>& s,
                              double alpha) {
  Vector<T>& parameters = model_.parameters();
  for (Index i = 0; i < s.size(); ++i)
    parameters(i) =
        static_cast<T>(std::fma(alpha, s(i), static_cast<double>(theta_(i))));
  return signal.objective();
}

template <class T>
bool HessianFreeRule<T>::operator()(Signal<T>& signal) {
  theta_ = model_.parameters();
  HessianFreeReport report{.damping = damping_};
  report.before = signal.objective();
  const Vector<double> g = signal.gradient().template cast<double>();
  if (!std::isfinite(report.before) || !g.allFinite()) return false;

  auto [model, stored] = solve(signal, g);
  std::size_t numbers = 0;
  for (const auto& [i, s] : stored) {
    report.stored.push_back(i);
    numbers += static_cast<std::size_t>(s.size());
  }
  stored_ = std::max(stored_, numbers);
  start_ = stored.back().second;
  report.model = model;
  const auto refuse = [&] {
    model_.parameters() = theta_;
    return false;
  };
  if (!start_.allFinite()) return refuse();

  double f = at(signal, start_, 1);
  report.rho = (f - at(signal, stored.front().second, 1)) /
               (model.back() - model.front());
  if (!(report.rho >= kLow)) damping_ *= kGrow;
  if (report.rho > kHigh) damping_ /= kGrow;
  report.next_damping = damping_;

  // A NaN is never lower; one at the end gives way to any number.
  std::size_t best = stored.size() - 1;
  for (; best > 0; --best) {
    const double earlier = at(signal, stored[best - 1].second, 1);
    if (earlier >= f || std::isnan(earlier)) break;
    f = earlier;
  }
  const Vector<double>& s = stored[best].second;
  report.chosen = stored[best].first;

  const double slope = dot(g, s);
  double alpha = 1;
  int trial = 0;
  for (; trial < kTrials; ++trial, alpha *= kShorter) {
    if (trial > 0) f = at(signal, s, alpha);
    if (f <= report.before + kDescent * alpha * slope) break;
  }
  if (trial == kTrials) alpha = 0;
  report.alpha = alpha;
  report.after = at(signal, s, options_.rate * alpha);
  reports_.push_back(std::move(report));
  return model_.parameters().allFinite() || refuse();
}

template <class T>
void HessianFreeRule<T>::export_to(Outcome& out) const {
  const auto row = [&](ArrayKey name, auto&& of) {
    std::vector<double> values;
    for (const HessianFreeReport& r : reports_) values.push_back(of(r));
    out.arrays[name] = as_row(values);
  };
  using R = HessianFreeReport;
  row("cg_iterations", [](const R& r) { return double(r.model.size()) - 1; });
  row("damping", [](const R& r) { return r.damping; });
  row("rho", [](const R& r) { return r.rho; });
  row("chosen", [](const R& r) { return double(r.chosen); });
  row("alpha", [](const R& r) { return r.alpha; });
  row("objective", [](const R& r) { return r.before; });
  row("objective_after", [](const R& r) { return r.after; });
}

template <class T>
std::size_t HessianFreeRule<T>::bytes() const {
  const auto parameters = static_cast<std::size_t>(theta_.size());
  // g, start, and four of the solve in addition to those it stores.
  return 3 * parameters * sizeof(T) +
         (6 * parameters + stored_) * sizeof(double);
}

template class HessianFreeRule<float>;
template class HessianFreeRule<double>;

}  // namespace physinv
