/// Methods written in Python: stages like any other, run in the worker that
/// owns their case.
#pragma once

#include <pybind11/pybind11.h>

namespace physinv::python {

void define_method(pybind11::module_& module);

}  // namespace physinv::python
