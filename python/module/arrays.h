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

/// The array of T that an argument is or can be taken for; else TypeError.
template <class T>
Array<T> taken(const py::object& argument, std::string_view name) {
  if (Array<T>::check_(argument))
    return py::reinterpret_borrow<Array<T>>(argument);
  if (py::isinstance<py::array>(argument) &&
      py::reinterpret_borrow<py::array>(argument).dtype().kind() == 'c')
    throw py::type_error(
        fmt::format("{} is complex; real numbers are right", name));
  auto array = Array<T>::ensure(argument);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(fmt::format("{} is no array of numbers", name));
  }
  return array;
}

/// ValueError for what is no (samples, features) of these sizes.
template <class T>
View<T> view(const Array<T>& array,
             std::string_view name,
             Index samples,
             Index features) {
  if (array.ndim() != 2 || array.shape(0) != samples ||
      array.shape(1) != features) {
    std::string shape;
    for (py::ssize_t i = 0; i < array.ndim(); ++i)
      shape += fmt::format("{}{}", i == 0 ? "" : ", ", array.shape(i));
    throw py::value_error(
        fmt::format("{} is ({}); (samples, features) = ({}, "
                    "{}) is right",
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
