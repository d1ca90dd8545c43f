#include "python/module/solving.h"

#include <pybind11/stl.h>

#include <algorithm>

#include "optimizers/network_model.h"
#include "suite/core/float_environment.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv::python {
namespace {

/// A matrix is [out][in]; other tensors are flat, in the network's order.
Array<double> tensor(const TensorInfo& info, const double* numbers) {
  const bool matrix = info.kind == 'm' && info.fan_in > 0;
  const std::vector<Index> shape =
      matrix ? std::vector<Index>{info.size / info.fan_in, info.fan_in}
             : std::vector<Index>{info.size};
  return Array<double>(shape, numbers + info.offset);
}

}  // namespace

StageRun& Solving::get() const {
  if (run_ == nullptr) throw std::runtime_error("this run has already ended");
  return *run_;
}

Index Solving::n() const { return oracle().count(); }

Array<double> Solving::start() const {
  return to_array(Batch<double>(oracle().start()));
}

Array<double> Solving::given() const { return to_array(oracle().given()); }

Array<double> Solving::observations() const {
  return to_array(oracle().observations());
}

py::dict Solving::network() const {
  const DefaultFloatEnvironment floats;
  const Setting& setting = get().setting;
  const NetworkRole& role = setting.predictor;
  if (role.inputs.empty())
    throw py::value_error(
        "a method needs needs=(\"vjp\", \"network\") to use the experiment's "
        "network");
  NetworkModel<double> model(
      role, oracle().shape(), oracle().shape().unknowns, get().threads);
  model.initialize(get().network_init);
  py::dict weights;
  for (const TensorInfo& info : model.network().tensors())
    weights[py::str(info.name)] = tensor(info, model.parameters().data());
  py::dict all;
  all["description"] = role.recipe.description;
  all["inputs"] = to_array(assemble<double>(role.inputs,
                                            oracle().start(),
                                            oracle().given(),
                                            oracle().observations()));
  all["weights"] = weights;
  all["output_scale"] = setting.output_scale;
  return all;
}

Array<double> Solving::loss(const py::object& x, const py::object& active) {
  const DefaultFloatEnvironment floats;
  const auto chosen = problems(active);
  const auto array = taken<double>(x, "x");
  const auto in = points(array, chosen);
  Vector<double> loss(in.cols());
  oracle().evaluate<double>(chosen, in, loss);
  count(chosen);
  return to_array(loss);
}

py::tuple Solving::loss_and_gradient(const py::object& x,
                                     const py::object& active) {
  const DefaultFloatEnvironment floats;
  const auto chosen = problems(active);
  const auto array = taken<double>(x, "x");
  const auto in = points(array, chosen);
  Vector<double> loss(in.cols());
  auto gradient = make_array<double>(in.cols(), in.rows());
  oracle().evaluate<double>(chosen, in, loss, writable(gradient));
  count(chosen);
  return py::make_tuple(to_array(loss), gradient);
}

py::tuple Solving::labelled(Index per_problem) const {
  const DefaultFloatEnvironment floats;
  const auto& s = oracle().labelled(per_problem);
  return py::make_tuple(to_array(s.x), to_array(s.y), to_array(s.given));
}

bool Solving::proceed(const py::object& x) {
  const DefaultFloatEnvironment floats;
  const Batch<double> in = estimates(x);
  told_ = true;
  return get().probe.proceed([&](BatchOut<double> out) { out = in; });
}

void Solving::accept(Index example,
                     Index iteration,
                     const py::object& x,
                     const py::object& loss) {
  if (example < 0 || example >= n())
    throw py::value_error(
        fmt::format("example {} of {} from 0 on", example, n()));
  if (iteration < 0 || iteration > iterations())
    throw py::value_error(fmt::format(
        "iteration {} is not in the budget of {}", iteration, iterations()));
  const auto at = taken<double>(x, "x");
  const auto lost = taken<double>(loss, "loss");
  if (lost.size() != 1) throw py::value_error("loss must be one number");
  if (at.ndim() != 1 || at.shape(0) != oracle().shape().unknowns)
    throw py::value_error(
        fmt::format("x must have the {} unknowns of an example",
                    oracle().shape().unknowns));
  told_ = accepted_ = true;
  get().probe.accept(example, iteration, at.data(), *lost.data());
  double& reached = accepted_iterations_(example);
  reached = std::max(reached, static_cast<double>(iteration));
}

Batch<double> Solving::estimates(const py::object& x) const {
  return points(taken<double>(x, "x"), all());
}

Vector<double> Solving::counted_iterations() const {
  if (accepted_) return accepted_iterations_;
  return Vector<double>::Constant(n(),
                                  static_cast<double>(get().probe.iteration()));
}

void Solving::count(const std::vector<Index>& chosen) {
  for (const Index i : chosen) evaluations_(i) += 1;
}

View<double> Solving::points(const Array<double>& x,
                             const std::vector<Index>& chosen) const {
  return view<double>(
      x, "x", static_cast<Index>(chosen.size()), oracle().shape().unknowns);
}

std::vector<Index> Solving::all() const {
  return {oracle().all().begin(), oracle().all().end()};
}

std::vector<Index> Solving::problems(const py::object& active) const {
  if (active.is_none()) return all();
  const py::array given = numbers(active, "active");
  const char kind = given.dtype().kind();
  const bool mask = kind == 'b' && given.size() == n();
  const bool indices = kind == 'i' || kind == 'u' || given.size() == 0;
  if (given.ndim() != 1 || !(mask || indices))
    throw py::type_error(fmt::format(
        "active must be a list of problem indices from 0 on or of {} bools",
        n()));
  const Array<Index> list(given);
  std::vector<Index> chosen;
  for (Index i = 0; i < list.size(); ++i) {
    const Index it = *list.data(i);
    if (!mask && (it < 0 || it >= n()))
      throw py::value_error(fmt::format("problem {} of {} from 0 on", it, n()));
    if (!mask || it != 0) chosen.push_back(mask ? i : it);
  }
  return chosen;
}

void Solving::finish() {
  if (!told_)
    throw std::runtime_error(
        "the method called neither run.proceed nor run.accept, so it has no "
        "curve");
  if (accepted_) get().probe.finish();
}

namespace {

using Run = py::class_<Solving, std::shared_ptr<Solving>>;

void define_case(Run& run) {
  run.def_property_readonly("n", &Solving::n, "Problems of the case.")
      .def_property_readonly("iterations", &Solving::iterations, "The budget.")
      .def_property_readonly(
          "gtol",
          &Solving::gtol,
          "The norm of a gradient (largest entry) at which the suite's solvers "
          "end a\nproblem as converged.")
      .def_property_readonly(
          "start", &Solving::start, "First guesses: (n, unknowns).")
      .def_property_readonly(
          "given", &Solving::given, "Side input: (n, side input).")
      .def_property_readonly("observations",
                             &Solving::observations,
                             "What x is sought for: (n, observations).")
      .def_property_readonly(
          "seed",
          &Solving::seed,
          "For the method's own random numbers, the same at every "
          "reading.")
      .def(
          "network",
          &Solving::network,
          "network($self)\n--\n\n"
          "The experiment's network, as every method of the case begins with "
          "it: a dict of\n`description`, `inputs` (n, features), `weights` (by "
          "name; matrices [out][in]) and\n`output_scale`: x = start + scale * "
          "output where the experiment has it linear. Needs network.")
      .def("labelled",
           &Solving::labelled,
           py::arg("per_problem") = 1,
           "labelled($self, per_problem=1)\n--\n\n"
           "x, y and given, so many for each problem, to learn from. Needs "
           "labels.");
}

void define_losses(Run& run) {
  const auto active = py::arg("active") = py::none();
  run.def(
         "loss",
         &Solving::loss,
         py::arg("x"),
         active,
         "loss($self, x, active=None)\n--\n\n"
         "Losses (k,) at x (k, unknowns) of the problems `active`, by default "
         "all n;\ncounted. Problems are named by their indices, or by n bools.")
      .def("loss_and_gradient",
           &Solving::loss_and_gradient,
           py::arg("x"),
           active,
           "loss_and_gradient($self, x, active=None)\n--\n\n"
           "Losses (k,) and d loss / d x (k, unknowns); counted. Needs vjp.");
}

void define_curve(Run& run) {
  run.def("proceed",
          &Solving::proceed,
          py::arg("x"),
          "proceed($self, x)\n--\n\nwhile run.proceed(x): counts an iteration, "
          "measures x (n, unknowns) while the\nclock is stopped, and is False "
          "when the budget is spent.")
      .def("accept",
           &Solving::accept,
           py::arg("example"),
           py::arg("iteration"),
           py::arg("x"),
           py::arg("loss"),
           "accept($self, example, iteration, x, loss)\n--\n\n"
           "For solvers that go example by example: its iterate x (unknowns,), "
           "from\niteration 0, the start, on.");
}

}  // namespace

void define_solving(py::module_& module) {
  py::options signatures;
  signatures.disable_function_signatures();
  Run run(
      module,
      "Run",
      "What a method sees of its case: n problems without their solutions, all "
      "calls\ncounted, a budget. Arrays are in double.");
  define_case(run);
  define_losses(run);
  define_curve(run);
}

}  // namespace physinv::python
