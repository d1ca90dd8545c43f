#include "python/module/user_experiment.h"

#include <pybind11/stl.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "python/module/method.h"
#include "python/module/user_problem.h"
#include "suite/cases/matrix/cells/own.h"
#include "suite/harness/registry.h"

namespace physinv::python {
namespace {

/// Of each experiment, what returns the words that its key has of the problem.
std::map<std::string, py::function>& words_of_problems() {
  // Not destroyed at exit, when Python has ended.
  static auto& all = *new std::map<std::string, py::function>;
  return all;
}

Options options_of(const py::function& words) {
  return words().cast<Options>();
}

/// In the place of the one of its name, or behind all.
void put(Experiment experiment) {
  Registry next;
  bool is_new = true;
  for (const auto& e : registry().experiments()) {
    const bool same = e->name == experiment.name;
    next.add(same ? std::move(experiment) : Experiment(*e));
    is_new = is_new && !same;
  }
  if (is_new) next.add(std::move(experiment));
  for (const Overview& o : registry().overviews()) next.add(o);
  registry() = std::move(next);
}

std::shared_ptr<const Functions> functions_of(const std::string& experiment,
                                              const py::dict& given) {
  const auto start = given["start"].cast<Array<double>>();
  const auto sizes = given["shape"].cast<std::vector<Index>>();
  return shared(
      {.name = experiment,
       .shape = {sizes[0], sizes[1], sizes[2]},
       .start = Eigen::Map<const Vector<double>>(start.data(), start.size()),
       .operations = given["operations"].cast<double>(),
       .sample = given["sample"],
       .forward = given["forward"],
       .vjp = given["vjp"],
       .jvp = given["jvp"],
       .jacobian = given["jacobian"],
       .inverse = given["inverse"]});
}

Quantities::Array columns(const py::dict& quantities, const char* name) {
  const auto [names, unit] =
      quantities[name].cast<std::pair<std::string, std::string>>();
  return {names, unit};
}

matrix::OwnOptions settings_of(const py::dict& given) {
  matrix::OwnOptions o;
  o.title = given["title"].cast<std::string>();
  o.gtol = given["gtol"].cast<double>();
  o.hidden = given["hidden"].cast<std::vector<Index>>();
  o.n = given["n"].cast<Index>();
  o.iterations = given["iterations"].cast<Index>();
  o.updates = given["updates"].cast<Index>();
  o.batch = given["batch"].cast<Index>();
  return o;
}

/// Adds the experiment, or puts it in the place of an earlier one from Python,
/// whose methods in Python stay. Returns what is skipped, and why.
std::vector<std::pair<std::string, std::string>> add_problem(
    const std::string& name,
    const py::dict& functions,
    const py::dict& quantities,
    const py::dict& settings,
    const py::function& words) {
  matrix::OwnOptions o = settings_of(settings);
  o.name = name;
  const std::string full = "matrix/" + name;
  const auto before = registry().find(full);
  if (before && !words_of_problems().contains(full))
    throw py::value_error(fmt::format(
        "the suite already has an experiment {}; choose another name", full));
  const auto calls = functions_of(full, functions);
  o.shape = calls->shape;
  o.problem = recipe_of(calls,
                        name,
                        options_of(words),
                        {.unknowns = columns(quantities, "unknowns"),
                         .observations = columns(quantities, "observations"),
                         .given = columns(quantities, "given")});
  Experiment e = matrix::own_experiment(o);
  if (before) e = with_methods_of(*before, std::move(e));
  words_of_problems()[full] = words;
  matrix::add_problem(matrix::own_row(o));
  put(std::move(e));
  return matrix::skipped_methods(matrix::own_row(o));
}

}  // namespace

void renew_problems() {
  for (const auto& [name, words] : words_of_problems()) {
    const auto e = registry().find(name);
    Options options = options_of(words);
    if (options == e->problem.options) continue;
    Experiment renewed = *e;
    renewed.problem.options = std::move(options);
    put(std::move(renewed));
  }
}

void define_user_experiment(py::module_& module) {
  module.def("add_problem", &add_problem);
}

}  // namespace physinv::python
