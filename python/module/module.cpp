// The extension module behind the Python package `physinv`.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "python/module/method.h"
#include "python/module/problem.h"
#include "python/module/results.h"
#include "suite/harness/context.h"
#include "suite/harness/registry.h"

PYBIND11_MODULE(_core, module) {
  namespace python = physinv::python;
  module.def("problem", &python::find_problem, pybind11::arg("name"));
  module.def("problems", [] {
    std::vector<std::string> names;
    for (const auto& e : physinv::registry().experiments())
      names.push_back(e->name);
    return names;
  });
  module.def("version_text", &physinv::version_text);
  python::define_problem(module);
  python::define_results(module);
  python::define_method(module);
}
