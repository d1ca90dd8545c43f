#include "python/module/problem.h"

#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include "suite/core/check.h"
#include "suite/harness/registry.h"
#include "suite/harness/select.h"

namespace physinv::python {
namespace {

using Released = py::gil_scoped_release;

template <class T>
Index samples_of(const Array<T>& array) {
  return array.ndim() > 0 ? array.shape(0) : 0;
}

}  // namespace

template <class T>
Side<T>& Sides::of() {
  auto& side = [&]() -> auto& {
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

template <class T>
Linearization<T>::Linearization(std::shared_ptr<Sides> sides,
                                std::string name,
                                Index samples)
    : sides_(std::move(sides)),
      name_(std::move(name)),
      samples_(samples),
      tape_(sides_->of<T>().tapes.take()) {}

template <class T>
Array<T> Linearization<T>::pullback(const Array<T>& y_bar) const {
  auto& side = sides_->of<T>();
  const Shape shape = side.problem->shape();
  const auto in = view<T>(y_bar, "y_bar", samples_, shape.observations);
  auto x_bar = make_array<T>(samples_, shape.unknowns);
  auto out = writable(x_bar);
  const Released released;
  const auto work = side.work.take();
  dynamic_cast<const Vjp<T>&>(*side.problem).pullback(*tape_, in, out, *work);
  return x_bar;
}

template <class T>
Array<T> Linearization<T>::pushforward(const Array<T>& x_dot) const {
  auto& side = sides_->of<T>();
  const auto* jvp = dynamic_cast<const Jvp<T>*>(side.problem.get());
  if (jvp == nullptr)
    throw py::type_error(name_ + " provides no jvp, which pushforward needs");
  const Shape shape = side.problem->shape();
  const auto in = view<T>(x_dot, "x_dot", samples_, shape.unknowns);
  auto y_dot = make_array<T>(samples_, shape.observations);
  auto out = writable(y_dot);
  const Released released;
  const auto work = side.work.take();
  jvp->pushforward(*tape_, in, out, *work);
  return y_dot;
}

PyProblem::PyProblem(std::shared_ptr<const Experiment> experiment)
    : experiment_(std::move(experiment)),
      sides_(std::make_shared<Sides>(experiment_->problem)),
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

Array<double> PyProblem::start() {
  return to_array(sides_->of<double>().problem->start());
}

py::tuple PyProblem::sample(std::uint64_t seed,
                            Index n,
                            Index first,
                            bool labelled) {
  if (n < 1 || first < 0)
    throw py::value_error(fmt::format(
        "n={} from {}; n is at least 1, the first at least 0", n, first));
  const Rng root = Rng::root(experiment_->name, seed);
  Samples<double> s;
  {
    const Released released;
    const auto& problem = *sides_->of<double>().problem;
    s = labelled ? problem.sample_labelled(first, n, root.child("data/train"))
                 : problem.sample(first, n, root.child("data/test"));
  }
  return py::make_tuple(to_array(s.x), to_array(s.y), to_array(s.given));
}

template <template <class> class Ability, class T>
const Ability<T>& PyProblem::need(const char* ability) {
  const auto* it =
      dynamic_cast<const Ability<T>*>(sides_->of<T>().problem.get());
  if (it == nullptr)
    throw py::type_error(fmt::format("{} provides {}, no {}",
                                     name(),
                                     to_text(experiment_->problem.provided),
                                     ability));
  return *it;
}

template <class T>
View<T> PyProblem::side_input(const std::optional<Array<T>>& given,
                              Index samples) const {
  if (given) return view<T>(*given, "given", samples, shape_.given);
  if (shape_.given > 0)
    throw py::value_error(
        fmt::format("{} needs given, (samples, features) = ({}, {})",
                    name(),
                    samples,
                    shape_.given));
  return {nullptr, 0, samples};
}

template <class T>
View<T> PyProblem::unknowns(const Array<T>& x) const {
  return view<T>(x, "x", samples_of(x), shape_.unknowns);
}

template <class T>
Array<T> PyProblem::forward(const Array<T>& x,
                            const std::optional<Array<T>>& given) {
  const auto in = unknowns(x);
  const auto side = side_input(given, in.cols());
  auto y = make_array<T>(in.cols(), shape_.observations);
  auto out = writable(y);
  const Released released;
  auto& own = sides_->of<T>();
  const auto work = own.work.take();
  own.problem->forward(in, side, out, *work);
  return y;
}

template <class T>
py::tuple PyProblem::linearize(const Array<T>& x,
                               const std::optional<Array<T>>& given) {
  const auto& vjp = need<Vjp, T>("vjp, which linearize needs");
  const auto in = unknowns(x);
  const auto side = side_input(given, in.cols());
  auto y = make_array<T>(in.cols(), shape_.observations);
  auto out = writable(y);
  auto point = std::make_shared<Linearization<T>>(sides_, name(), in.cols());
  {
    const Released released;
    vjp.linearize(in, side, out, point->tape());
  }
  return py::make_tuple(y, point);
}

template <class T>
py::object PyProblem::jacobian(const Array<T>& x,
                               const std::optional<Array<T>>& given) {
  const auto& jacobian = need<Jacobian, T>("jacobian");
  const auto in = unknowns(x);
  const auto side = side_input(given, in.cols());
  Array<T> j({in.cols(), shape_.unknowns, shape_.observations});
  {
    Eigen::Map<Batch<T>> out(
        j.mutable_data(), shape_.unknowns * shape_.observations, in.cols());
    const Released released;
    const auto work = sides_->of<T>().work.take();
    jacobian.jacobian(in, side, out, *work);
  }
  return j.attr("transpose")(0, 2, 1);
}

template <class T>
Array<T> PyProblem::hessian(const Array<T>& x,
                            const Array<T>& target,
                            const std::optional<Array<T>>& given) {
  const auto& hessian = need<Hessian, T>("hessian");
  const auto in = unknowns(x);
  const auto side = side_input(given, in.cols());
  const auto y = view<T>(target, "target", in.cols(), shape_.observations);
  Array<T> h({in.cols(), shape_.unknowns, shape_.unknowns});
  Eigen::Map<Batch<T>> out(
      h.mutable_data(), shape_.unknowns * shape_.unknowns, in.cols());
  const Released released;
  const auto work = sides_->of<T>().work.take();
  hessian.hessian(in, side, y, out, *work);
  return h;
}

template <class T>
Array<T> PyProblem::invert(const Array<T>& y,
                           const std::optional<Array<T>>& given,
                           const std::optional<Array<T>>& guess) {
  const auto& inverse = need<Inverse, T>("inverse");
  const Index samples = samples_of(y);
  const auto in = view<T>(y, "y", samples, shape_.observations);
  const auto side = side_input(given, samples);
  Array<T> from = make_array<T>(samples, shape_.unknowns);
  if (guess) {
    view<T>(*guess, "guess", samples, shape_.unknowns);
    from = *guess;
  } else {
    writable(from).colwise() =
        sides_->of<double>().problem->start().template cast<T>();
  }
  const View<T> near(from.data(), shape_.unknowns, samples);
  auto x = make_array<T>(samples, shape_.unknowns);
  auto out = writable(x);
  const Released released;
  const auto work = sides_->of<T>().work.take();
  inverse.invert(in, side, near, out, *work);
  return x;
}

template <class T>
Array<double> PyProblem::loss(const Array<T>& y, const Array<T>& target) {
  const Index samples = samples_of(y);
  const auto a = view<T>(y, "y", samples, shape_.observations);
  const auto b = view<T>(target, "target", samples, shape_.observations);
  Array<double> loss(samples);
  Eigen::Map<Vector<double>> out(loss.mutable_data(), samples);
  const Released released;
  sides_->of<T>().problem->loss(a, b, out);
  return loss;
}

template <class T>
Array<T> PyProblem::loss_gradient(const Array<T>& y, const Array<T>& target) {
  const Index samples = samples_of(y);
  const auto a = view<T>(y, "y", samples, shape_.observations);
  const auto b = view<T>(target, "target", samples, shape_.observations);
  auto y_bar = make_array<T>(samples, shape_.observations);
  auto out = writable(y_bar);
  const Released released;
  sides_->of<T>().problem->loss_gradient(a, b, out);
  return y_bar;
}

PyProblem find_problem(const std::string& name) {
  if (const auto e = registry().find(name)) return PyProblem(e);
  std::vector<std::string> names;
  for (const auto& e : registry().experiments()) names.push_back(e->name);
  throw py::value_error(
      fmt::format("there is no problem '{}'; nearest are {}",
                  name,
                  fmt::join(nearest_names(names, name), ", ")));
}

template class Linearization<float>;
template class Linearization<double>;

namespace {

template <class T>
void define_linearization(py::module_& module, const char* name) {
  using L = Linearization<T>;
  py::class_<L, std::shared_ptr<L>>(module, name)
      .def("pullback",
           &L::pullback,
           py::arg("y_bar"),
           "J^T y_bar: (samples, observations) -> (samples, unknowns).")
      .def("pushforward",
           &L::pushforward,
           py::arg("x_dot"),
           "J x_dot: (samples, unknowns) -> (samples, observations).");
}

/// The array of T that an argument is or can be taken for.
template <class T>
Array<T> taken(const py::object& argument, const char* name) {
  auto array = Array<T>::ensure(argument);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(fmt::format("{} is no array of numbers", name));
  }
  return array;
}

template <class T>
std::optional<Array<T>> if_any(const py::object& argument, const char* name) {
  if (argument.is_none()) return {};
  return taken<T>(argument, name);
}

/// f of the first argument: in single precision where that is, else in double.
template <class F>
py::object in_its_precision(const py::object& first, const char* name, F&& f) {
  if (py::isinstance<py::array_t<float>>(first))
    return f(taken<float>(first, name));
  return f(taken<double>(first, name));
}

template <class T>
using Number = typename T::value_type;

template <class C>
void define_passes(C& c) {
  const auto given = py::arg("given") = py::none();
  c.def(
      "forward",
      [](PyProblem& p, const py::object& x, const py::object& side) {
        return in_its_precision(x, "x", [&](const auto& in) -> py::object {
          using T = Number<std::decay_t<decltype(in)>>;
          return p.forward<T>(in, if_any<T>(side, "given"));
        });
      },
      py::arg("x"),
      given,
      "Observations y = F(x | given): (samples, observations).");
  c.def(
      "linearize",
      [](PyProblem& p, const py::object& x, const py::object& side) {
        return in_its_precision(x, "x", [&](const auto& in) -> py::object {
          using T = Number<std::decay_t<decltype(in)>>;
          return p.linearize<T>(in, if_any<T>(side, "given"));
        });
      },
      py::arg("x"),
      given,
      "y = F(x | given) and a tape, whose `pullback` and `pushforward` are "
      "products with the Jacobian at x and its transpose.");
  c.def(
      "jacobian",
      [](PyProblem& p, const py::object& x, const py::object& side) {
        return in_its_precision(x, "x", [&](const auto& in) -> py::object {
          using T = Number<std::decay_t<decltype(in)>>;
          return p.jacobian<T>(in, if_any<T>(side, "given"));
        });
      },
      py::arg("x"),
      given,
      "dy / dx: (samples, observations, unknowns).");
}

template <class C>
void define_others(C& c) {
  const auto given = py::arg("given") = py::none();
  c.def(
      "hessian",
      [](PyProblem& p,
         const py::object& x,
         const py::object& target,
         const py::object& side) {
        return in_its_precision(x, "x", [&](const auto& in) -> py::object {
          using T = Number<std::decay_t<decltype(in)>>;
          return p.hessian<T>(
              in, taken<T>(target, "target"), if_any<T>(side, "given"));
        });
      },
      py::arg("x"),
      py::arg("target"),
      given,
      "Second derivative of the loss: (samples, unknowns, unknowns).");
  c.def(
      "invert",
      [](PyProblem& p,
         const py::object& y,
         const py::object& side,
         const py::object& guess) {
        return in_its_precision(y, "y", [&](const auto& in) -> py::object {
          using T = Number<std::decay_t<decltype(in)>>;
          return p.invert<T>(
              in, if_any<T>(side, "given"), if_any<T>(guess, "guess"));
        });
      },
      py::arg("y"),
      given,
      py::arg("guess") = py::none(),
      "x near `guess` (default: the start) with F(x | given) = y.");
}

template <class C>
void define_losses(C& c) {
  c.def(
      "loss",
      [](PyProblem& p, const py::object& y, const py::object& target) {
        return in_its_precision(y, "y", [&](const auto& in) -> py::object {
          using T = Number<std::decay_t<decltype(in)>>;
          return p.loss<T>(in, taken<T>(target, "target"));
        });
      },
      py::arg("y"),
      py::arg("target"),
      "Loss of each sample, in double: (samples,).");
  c.def(
      "loss_gradient",
      [](PyProblem& p, const py::object& y, const py::object& target) {
        return in_its_precision(y, "y", [&](const auto& in) -> py::object {
          using T = Number<std::decay_t<decltype(in)>>;
          return p.loss_gradient<T>(in, taken<T>(target, "target"));
        });
      },
      py::arg("y"),
      py::arg("target"),
      "d loss / d y: (samples, observations).");
}

}  // namespace

void define_problem(py::module_& module) {
  define_linearization<float>(module, "Tape32");
  define_linearization<double>(module, "Tape64");
  py::class_<PyProblem> c(module, "Problem");
  c.def_property_readonly("name", &PyProblem::name)
      .def_property_readonly(
          "names",
          [](const PyProblem& p) { return py::tuple(py::cast(p.abilities())); },
          "What the problem provides: forward, vjp, jacobian, ...")
      .def_property_readonly(
          "shape",
          [](const PyProblem& p) {
            const Shape s = p.shape();
            return py::make_tuple(s.unknowns, s.observations, s.given);
          },
          "Features of x, y and given.")
      .def_property_readonly(
          "options",
          [](const PyProblem& p) {
            py::dict all;
            for (const auto& [key, value] : p.options())
              all[py::str(key)] = value;
            return all;
          },
          "What defines the problem, in words.")
      .def_property_readonly(
          "start", &PyProblem::start, "Where classical optimizers start.")
      .def("_sample",
           &PyProblem::sample,
           py::arg("seed"),
           py::arg("n"),
           py::arg("first"),
           py::arg("labelled"))
      .def("__repr__", [](const PyProblem& p) {
        const Shape s = p.shape();
        return fmt::format(
            "<physinv problem {}: {} unknowns, {} observations, "
            "{} given; {}>",
            p.name(),
            s.unknowns,
            s.observations,
            s.given,
            fmt::join(p.abilities(), ", "));
      });
  define_passes(c);
  define_others(c);
  define_losses(c);
}

}  // namespace physinv::python
