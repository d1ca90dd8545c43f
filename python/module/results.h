/// Finished campaigns for Python.
#pragma once

#include <pybind11/pybind11.h>

namespace physinv::python {

void define_results(pybind11::module_& module);

}  // namespace physinv::python
