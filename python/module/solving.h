/// What a method written in Python may see of its case, for as long as it runs.
#pragma once

#include <vector>

#include "python/module/arrays.h"
#include "suite/core/method.h"

namespace physinv::python {

class Solving {
 public:
  explicit Solving(StageRun& run)
      : run_(&run),
        accepted_iterations_(Vector<double>::Zero(n())),
        evaluations_(Vector<double>::Zero(n())) {}

  Index n() const;
  Index iterations() const { return get().iterations; }
  double gtol() const { return get().setting.gtol; }
  Array<double> start() const;
  Array<double> given() const;
  Array<double> observations() const;
  std::uint64_t seed() const { return get().method.stream().bits(); }
  /// The experiment's network as every method of the case begins with it.
  py::dict network() const;

  /// Of the problems `active`: None for all, indices, or a bool for each.
  Array<double> loss(const py::object& x, const py::object& active);
  py::tuple loss_and_gradient(const py::object& x, const py::object& active);
  py::tuple labelled(Index per_problem) const;

  bool proceed(const py::object& x);
  void accept(Index example,
              Index iteration,
              const py::object& x,
              const py::object& loss);

  /// An estimate of each problem; ValueError for another shape.
  Batch<double> estimates(const py::object& x) const;
  /// Of each problem: iterations that `proceed` counted, or the last one that
  /// was accepted, and losses that were asked for, with gradients and without.
  Vector<double> counted_iterations() const;
  Vector<double> counted_evaluations() const { return evaluations_; }
  /// Closes the curve. Throws if the method reported nothing.
  void finish();
  /// Nothing is seen from here on.
  void end() { run_ = nullptr; }

 private:
  StageRun& get() const;
  Oracle& oracle() const { return get().oracle; }
  View<double> points(const Array<double>& x,
                      const std::vector<Index>& chosen) const;
  std::vector<Index> all() const;
  std::vector<Index> problems(const py::object& active) const;
  void count(const std::vector<Index>& chosen);

  StageRun* run_;
  bool told_ = false, accepted_ = false;
  Vector<double> accepted_iterations_, evaluations_;
};

/// Class `Run`.
void define_solving(py::module_& module);

}  // namespace physinv::python
