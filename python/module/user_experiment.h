/// Experiments of problems written in Python.
#pragma once

#include <pybind11/pybind11.h>

namespace physinv::python {

/// Before any verb, so that keys are of what the problems are now.
void renew_problems();

void define_user_experiment(pybind11::module_& module);

}  // namespace physinv::python
