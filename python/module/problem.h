/// A registered problem as Python sees it, in float and in double.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "python/module/arrays.h"
#include "python/module/pool.h"
#include "suite/core/recipe.h"
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
  explicit Sides(const Experiment& experiment)
      : name_(experiment.name), recipe_(experiment.problem) {}
  template <class T>
  Side<T>& of();
  /// An ability, or a TypeError that names those which are there.
  template <template <class> class Ability, class T>
  const Ability<T>& need(const char* ability);

 private:
  [[noreturn]] void refuse(const char* ability) const;

  std::string name_;
  ProblemRecipe recipe_;
  std::once_flag once_[2];
  Side<float> float_;
  Side<double> double_;
};

template <class T>
Side<T>& Sides::of() {
  auto& side = [this]() -> auto& {
    if constexpr (std::is_same_v<T, float>) {
      return float_;
    } else {
      return double_;
    }
  }
  ();
  std::call_once(once_[sizeof(T) / 8],
                 [&] { side.problem = recipe_.make<T>(); });
  return side;
}

template <template <class> class Ability, class T>
const Ability<T>& Sides::need(const char* ability) {
  const auto* it = dynamic_cast<const Ability<T>*>(of<T>().problem.get());
  if (it == nullptr) refuse(ability);
  return *it;
}

/// A linearization: products with the Jacobian and its transpose at its point.
template <class T>
class Linearization {
 public:
  Linearization(std::shared_ptr<Sides> sides, Index samples)
      : sides_(std::move(sides)),
        samples_(samples),
        tape_(sides_->of<T>().tapes.take()) {}

  Tape& tape() { return *tape_; }
  Array<T> pullback(const py::object& y_bar) const;
  Array<T> pushforward(const py::object& x_dot) const;

 private:
  std::shared_ptr<Sides> sides_;
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
  Array<double> start() const;
  py::tuple sample(std::uint64_t seed, Index n, Index first, bool labelled);
  const std::shared_ptr<Sides>& sides() const { return sides_; }

 private:
  std::shared_ptr<const Experiment> experiment_;
  std::shared_ptr<Sides> sides_;
  Shape shape_;
};

/// What is registered under this name; ValueError with the nearest names.
PyProblem find_problem(const std::string& name);

void define_problem(py::module_& module);

/// Its methods on arrays.
void define_calls(py::class_<PyProblem>& c);

}  // namespace physinv::python
