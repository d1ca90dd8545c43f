// The extension module behind the Python package `physinv`.
#include <dlfcn.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>

#include "python/module/method.h"
#include "python/module/problem.h"
#include "python/module/results.h"
#include "python/module/user_experiment.h"
#include "suite/app/plugins.h"
#include "suite/harness/context.h"
#include "suite/harness/registry.h"

namespace {

/// pybind11 supports the layout of NumPy 2 from version 2.12.
void check_numpy() {
  const auto version = pybind11::module_::import("numpy")
                           .attr("__version__")
                           .cast<std::string>();
  if (PYBIND11_VERSION_HEX < 0x020C0000 && std::stoi(version) >= 2)
    throw pybind11::import_error(
        "physinv is built with pybind11 " +
        std::to_string(PYBIND11_VERSION_MAJOR) + "." +
        std::to_string(PYBIND11_VERSION_MINOR) +
        ", which supports NumPy 1, but this is NumPy " + version +
        "; install numpy<2, or build with pybind11 2.12 or later");
}

/// Loads plug-ins, of PHYSINV_PLUGINS and by file; they find the suite in here.
void load_plugins(physinv::Arguments flags) {
  static const char here = 0;
  Dl_info info{};
  if (dladdr(&here, &info) == 0 ||
      dlopen(info.dli_fname, RTLD_NOW | RTLD_NOLOAD | RTLD_GLOBAL) == nullptr)
    throw std::runtime_error(
        "cannot make the symbols of the suite visible to plug-ins");
  try {
    physinv::load_plugins(flags);
  } catch (const physinv::UsageError& error) {
    throw pybind11::value_error(error.what());
  }
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  check_numpy();
  physinv::register_all(physinv::registry());
  namespace python = physinv::python;
  module.def("problem", &python::find_problem, pybind11::arg("name"));
  module.def("problems", [] {
    std::vector<std::string> names;
    for (const auto& e : physinv::registry().experiments())
      names.push_back(e->name);
    return names;
  });
  module.def("version_text", &physinv::version_text);
  module.def("load_plugins", &load_plugins);
  python::define_problem(module);
  python::define_results(module);
  python::define_method(module);
  python::define_user_experiment(module);
}
