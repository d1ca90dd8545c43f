/// NumPy's arrays (samples, features), C order, are the suite's batches without
/// a copy: one sample is contiguous in both.
#pragma once

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <string_view>

#include "suite/core/batch.h"

namespace physinv::python {

namespace py = pybind11;

template <class T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

template <class T>
using View = Eigen::Map<const Batch<T>>;

/// An array of numbers for an argument that is not a plain array of T. Complex
/// and masked arrays are none: what would be dropped is a TypeError.
inline py::array numbers(const py::object& argument, std::string_view name) {
  const py::object masked =
      py::module_::import("numpy").attr("ma").attr("MaskedArray");
  if (py::isinstance(argument, masked))
    throw py::type_error(fmt::format(
        "{} is a masked array; expected one without a mask, as from filled()",
        name));
  auto array = py::array::ensure(argument);
  PyErr_Clear();
  const char kind = array ? array.dtype().kind() : 'U';
  if (kind == 'c')
    throw py::type_error(
        fmt::format("{} is complex; expected real numbers", name));
  if (std::string_view("biufO").find(kind) == std::string_view::npos)
    throw py::type_error(fmt::format("{} is not an array of numbers", name));
  return array;
}

/// The array of T that an argument is or can be taken for; else TypeError.
template <class T>
Array<T> taken(const py::object& argument, std::string_view name) {
  const auto* plain = py::detail::npy_api::get().PyArray_Type_;
  if (Py_TYPE(argument.ptr()) == plain && Array<T>::check_(argument))
    return py::reinterpret_borrow<Array<T>>(argument);
  auto array = Array<T>::ensure(numbers(argument, name));
  if (!array) {
    PyErr_Clear();
    throw py::type_error(fmt::format("{} is not an array of numbers", name));
  }
  return array;
}

/// ValueError for what is not (samples, features) of these sizes.
template <class T>
View<T> view(const Array<T>& array,
             std::string_view name,
             Index samples,
             Index features) {
  if (array.ndim() != 2 || array.shape(0) != samples ||
      array.shape(1) != features) {
    if (array.ndim() == 1 && array.shape(0) == features)
      throw py::value_error(
          fmt::format("{0} is ({1}), a sample without its axis; expected "
                      "{0}[None], (1, {1})",
                      name,
                      features));
    std::string shape;
    for (py::ssize_t i = 0; i < array.ndim(); ++i)
      shape += fmt::format("{}{}", i == 0 ? "" : ", ", array.shape(i));
    throw py::value_error(
        fmt::format("{} is ({}); expected (samples, features) = ({}, {})",
                    name,
                    shape,
                    samples,
                    features));
  }
  return {array.data(), features, samples};
}

template <class T>
Array<T> make_array(Index samples, Index features) {
  return Array<T>({samples, features});
}

template <class T>
Eigen::Map<Batch<T>> writable(Array<T>& array) {
  return {array.mutable_data(), array.shape(1), array.shape(0)};
}

/// A copy.
template <class T>
Array<T> to_array(const Batch<T>& batch) {
  Array<T> array = make_array<T>(batch.cols(), batch.rows());
  writable(array) = batch;
  return array;
}

inline Array<double> to_array(const Vector<double>& values) {
  return Array<double>(values.size(), values.data());
}

}  // namespace physinv::python
