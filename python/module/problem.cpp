#include "python/module/problem.h"

#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include "suite/core/float_environment.h"
#include "suite/harness/registry.h"
#include "suite/harness/study.h"
#include "suite/results/nearest.h"

namespace physinv::python {
namespace {

using Released = py::gil_scoped_release;

}  // namespace

void Sides::refuse(const char* ability) const {
  throw py::type_error(fmt::format(
      "{} provides {}, no {}", name_, to_text(recipe_.provided), ability));
}

template <class T>
Array<T> Linearization<T>::pullback(const py::object& y_bar) const {
  auto& side = sides_->of<T>();
  const Shape shape = side.problem->shape();
  const auto array = taken<T>(y_bar, "y_bar");
  const auto in = view<T>(array, "y_bar", samples_, shape.observations);
  auto x_bar = make_array<T>(samples_, shape.unknowns);
  auto out = writable(x_bar);
  if (samples_ == 0) return x_bar;
  const Released released;
  const auto work = side.work.take();
  sides_->need<Vjp, T>("vjp").pullback(*tape_, in, out, *work);
  return x_bar;
}

template <class T>
Array<T> Linearization<T>::pushforward(const py::object& x_dot) const {
  const auto& jvp = sides_->need<Jvp, T>("jvp, which pushforward needs");
  auto& side = sides_->of<T>();
  const Shape shape = side.problem->shape();
  const auto array = taken<T>(x_dot, "x_dot");
  const auto in = view<T>(array, "x_dot", samples_, shape.unknowns);
  auto y_dot = make_array<T>(samples_, shape.observations);
  auto out = writable(y_dot);
  if (samples_ == 0) return y_dot;
  const Released released;
  const auto work = side.work.take();
  jvp.pushforward(*tape_, in, out, *work);
  return y_dot;
}

PyProblem::PyProblem(std::shared_ptr<const Experiment> experiment)
    : experiment_(std::move(experiment)),
      sides_(std::make_shared<Sides>(*experiment_)),
      shape_(sides_->of<double>().problem->shape()) {}

std::vector<std::string> PyProblem::abilities() const {
  std::string text = to_text(experiment_->problem.provided);
  std::vector<std::string> all;
  for (std::size_t at = 0; at != std::string::npos;) {
    const auto end = text.find('|', at);
    all.push_back(text.substr(at, end - at));
    at = end == std::string::npos ? end : end + 1;
  }
  return all;
}

Array<double> PyProblem::start() const {
  return to_array(sides_->of<double>().problem->start());
}

py::tuple PyProblem::sample(std::uint64_t seed,
                            Index n,
                            Index first,
                            bool labelled) {
  const Rng root = root_of(experiment_->name, seed);
  const DefaultFloatEnvironment floats;
  Samples<double> s;
  {
    const Released released;
    const auto& problem = *sides_->of<double>().problem;
    s = labelled ? problem.sample_labelled(first, n, root.child("data/train"))
                 : problem.sample(first, n, root.child("data/test"));
  }
  return py::make_tuple(to_array(s.x), to_array(s.y), to_array(s.given));
}

PyProblem find_problem(const std::string& name) {
  if (const auto e = registry().find(name)) return PyProblem(e);
  std::vector<std::string> names;
  for (const auto& e : registry().experiments()) names.push_back(e->name);
  throw py::value_error(
      fmt::format("there is no problem '{}'; nearest: {}",
                  name,
                  fmt::join(nearest_names(names, name), ", ")));
}

template class Linearization<float>;
template class Linearization<double>;

namespace {

template <class T>
void define_linearization(py::module_& module, const char* name) {
  using L = Linearization<T>;
  py::class_<L, std::shared_ptr<L>>(
      module,
      name,
      "The derivative of a problem at the point of `linearize`, which it keeps "
      "for as\nlong as it lives.")
      .def("pullback",
           &L::pullback,
           py::arg("y_bar"),
           "pullback($self, y_bar)\n--\n\n"
           "J^T y_bar, exact to rounding: y_bar (samples, observations), the "
           "slope of\nanything by y, gives its slope by x, (samples, "
           "unknowns).")
      .def("pushforward",
           &L::pushforward,
           py::arg("x_dot"),
           "pushforward($self, x_dot)\n--\n\n"
           "J x_dot: x_dot (samples, unknowns) gives (samples, "
           "observations). Needs jvp.");
}

py::dict options_of(const PyProblem& p) {
  py::dict all;
  for (const auto& [key, value] : p.options()) all[py::str(key)] = value;
  return all;
}

std::string text_of(const PyProblem& p) {
  const Shape s = p.shape();
  return fmt::format(
      "<physinv problem {}: {} unknowns, {} observations, {} given; {}>",
      p.name(),
      s.unknowns,
      s.observations,
      s.given,
      fmt::join(p.abilities(), ", "));
}

}  // namespace

void define_problem(py::module_& module) {
  py::options signatures;
  signatures.disable_function_signatures();
  define_linearization<float>(module, "Tape32");
  define_linearization<double>(module, "Tape64");
  py::class_<PyProblem> c(
      module,
      "Problem",
      "A physics inverse problem y = F(x | given): which x gives y?\n\n"
      "Arrays are (samples, features); a call answers in the precision of its "
      "first\narray. What x, y and given are, and in which units, says the "
      "header of the\nproblem, problems/<name>/<name>.h; `options` has its "
      "numbers.");
  c.def_property_readonly(
       "name", &PyProblem::name, "Of the experiment that has it: 'sip/heat'.")
      .def_property_readonly(
          "names",
          [](const PyProblem& p) { return py::tuple(py::cast(p.abilities())); },
          "What the problem provides: 'forward', 'vjp' (linearize, pullback), "
          "'jvp'\n(pushforward), 'jacobian', 'hessian', 'inverse' (invert), "
          "'labels' (pairs x, y).")
      .def_property_readonly(
          "shape",
          [](const PyProblem& p) {
            const Shape s = p.shape();
            return py::make_tuple(s.unknowns, s.observations, s.given);
          },
          "Features of x, y and given.")
      .def_property_readonly("options",
                             &options_of,
                             "What defines the problem, as a dict of texts.")
      .def_property_readonly(
          "start",
          &PyProblem::start,
          "Where classical optimizers start: (unknowns,), in double.")
      .def("_sample", &PyProblem::sample)
      .def("__repr__", &text_of);
  define_calls(c);
}

}  // namespace physinv::python
