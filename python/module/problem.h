/// A registered problem as Python sees it, in float and in double.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "python/module/arrays.h"
#include "python/module/pool.h"
#include "suite/harness/case.h"

namespace physinv::python {

/// What both precisions need: the problem of an experiment, its scratch.
template <class T>
struct Side {
  std::unique_ptr<Problem<T>> problem;
  Pool<Workspace> work;
  Pool<Tape> tapes;
};

/// Made when first used; shared by tapes.
class Sides {
 public:
  explicit Sides(const ProblemRecipe& recipe) : recipe_(recipe) {}
  template <class T>
  Side<T>& of();

 private:
  ProblemRecipe recipe_;
  std::once_flag once_[2];
  Side<float> float_;
  Side<double> double_;
};

/// A linearization: products with the Jacobian and its transpose at its point.
template <class T>
class Linearization {
 public:
  Linearization(std::shared_ptr<Sides> sides, std::string name, Index samples);

  Tape& tape() { return *tape_; }
  Array<T> pullback(const Array<T>& y_bar) const;
  Array<T> pushforward(const Array<T>& x_dot) const;

 private:
  std::shared_ptr<Sides> sides_;
  std::string name_;
  Index samples_;
  typename Pool<Tape>::Lease tape_;
};

class PyProblem {
 public:
  explicit PyProblem(std::shared_ptr<const Experiment> experiment);

  const std::string& name() const { return experiment_->name; }
  std::vector<std::string> abilities() const;
  Shape shape() const { return shape_; }
  const Options& options() const { return experiment_->problem.options; }
  Array<double> start();
  py::tuple sample(std::uint64_t seed, Index n, Index first, bool labelled);

  template <class T>
  Array<T> forward(const Array<T>& x, const std::optional<Array<T>>& given);
  template <class T>
  py::tuple linearize(const Array<T>& x, const std::optional<Array<T>>& given);
  template <class T>
  py::object jacobian(const Array<T>& x, const std::optional<Array<T>>& given);
  template <class T>
  Array<T> hessian(const Array<T>& x,
                   const Array<T>& target,
                   const std::optional<Array<T>>& given);
  template <class T>
  Array<T> invert(const Array<T>& y,
                  const std::optional<Array<T>>& given,
                  const std::optional<Array<T>>& guess);
  template <class T>
  Array<double> loss(const Array<T>& y, const Array<T>& target);
  template <class T>
  Array<T> loss_gradient(const Array<T>& y, const Array<T>& target);

 private:
  /// An ability, or an error that names those which are there.
  template <template <class> class Ability, class T>
  const Ability<T>& need(const char* ability);
  template <class T>
  View<T> side_input(const std::optional<Array<T>>& given, Index samples) const;
  template <class T>
  View<T> unknowns(const Array<T>& x) const;

  std::shared_ptr<const Experiment> experiment_;
  std::shared_ptr<Sides> sides_;
  Shape shape_;
};

/// What is registered under this name; ValueError with the nearest names.
PyProblem find_problem(const std::string& name);

void define_problem(py::module_& module);

}  // namespace physinv::python
