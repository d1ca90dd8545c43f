/// Methods written in Python: stages like any other, run in the worker that
/// owns their case.
#pragma once

#include <pybind11/pybind11.h>

#include "suite/harness/case.h"

namespace physinv::python {

/// With the methods in Python that `before` has, where the problem of `fresh`
/// provides what they need.
Experiment with_methods_of(const Experiment& before, Experiment fresh);

void define_method(pybind11::module_& module);

}  // namespace physinv::python
