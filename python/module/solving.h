/// What a method written in Python may see of its case, for as long as it runs.
#pragma once

#include <optional>
#include <vector>

#include "python/module/arrays.h"
#include "suite/core/method.h"

namespace physinv::python {

class Solving {
 public:
  explicit Solving(StageRun& run) : run_(&run) {}

  Index n() const;
  Index iterations() const { return get().iterations; }
  double gtol() const { return get().setting.gtol; }
  Array<double> start() const;
  Array<double> given() const;
  Array<double> observations() const;
  std::uint64_t seed() const { return get().method.stream().bits(); }
  /// The experiment's network as every method of the case begins with it.
  py::dict network() const;

  using Active = std::optional<std::vector<Index>>;
  Array<double> loss(const Array<double>& x, const Active& active) const;
  py::tuple loss_and_gradient(const Array<double>& x,
                              const Active& active) const;
  py::tuple labelled(Index per_problem) const;

  bool proceed(const Array<double>& x);
  void accept(Index example,
              Index iteration,
              const Array<double>& x,
              double loss);

  /// An estimate of each problem; ValueError for another shape.
  View<double> estimates(const Array<double>& x) const;
  /// Closes the curve. Throws if the method told nothing.
  void finish();
  /// Nothing is seen from here on.
  void end() { run_ = nullptr; }

 private:
  StageRun& get() const;
  Oracle& oracle() const { return get().oracle; }
  View<double> points(const Array<double>& x,
                      const std::vector<Index>& chosen) const;
  std::vector<Index> problems(const Active& active) const;

  StageRun* run_;
  bool told_ = false, accepted_ = false;
};

/// Class `Run`.
void define_solving(py::module_& module);

}  // namespace physinv::python
