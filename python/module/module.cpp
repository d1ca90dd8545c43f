// The extension module behind the Python package `physinv`.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>

#include "python/module/method.h"
#include "python/module/problem.h"
#include "python/module/results.h"
#include "suite/harness/context.h"
#include "suite/harness/registry.h"

namespace {

/// pybind11 knows the layout of NumPy 2 from 2.12 on.
void check_numpy() {
  const auto version = pybind11::module_::import("numpy")
                           .attr("__version__")
                           .cast<std::string>();
  if (PYBIND11_VERSION_HEX < 0x020C0000 && std::stoi(version) >= 2)
    throw pybind11::import_error(
        "physinv is built with pybind11 " +
        std::to_string(PYBIND11_VERSION_MAJOR) + "." +
        std::to_string(PYBIND11_VERSION_MINOR) +
        ", which knows NumPy 1, and this is NumPy " + version +
        "; numpy<2 is right, or a build with pybind11 2.12 or later");
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  check_numpy();
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
