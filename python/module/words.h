/// Exceptions of Python as lines of a record.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace physinv::python {

/// "ArithmeticError: not today"
std::string words_of(const pybind11::error_already_set& error);

}  // namespace physinv::python
