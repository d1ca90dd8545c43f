#include <fmt/format.h>

#include "suite/store/errors.h"
#include "suite/store/hdf5.h"

namespace physinv::hdf5 {
namespace {

/// What fits into the header of an object, where attributes stand.
constexpr std::size_t kLongestText = 1 << 16;

hid_t scalar() {
  static const Handle shape(H5Screate(H5S_SCALAR), H5Sclose, "make a shape");
  return shape;
}

void put(hid_t parent, const std::string& name, hid_t type, const void* value) {
  const Handle attribute(
      H5Acreate2(
          parent, name.c_str(), type, scalar(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose,
      "create attribute " + name);
  check(H5Awrite(attribute, type, value), "write attribute " + name);
}

/// H5Aread writes as many elements as there are.
bool is_scalar(const Handle& attribute) {
  const Handle space(H5Aget_space(attribute), H5Sclose, "read a shape");
  return H5Sget_simple_extent_type(space) == H5S_SCALAR;
}

Handle open(hid_t parent, const std::string& name) {
  return {H5Aopen(parent, name.c_str(), H5P_DEFAULT),
          H5Aclose,
          "open attribute " + name};
}

}  // namespace

void write_attribute(hid_t parent,
                     const std::string& name,
                     const std::string& value) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a text type");
  check(H5Tset_size(type, value.size() + 1), "make a text type");
  put(parent, name, type, value.c_str());
}

void write_attribute(hid_t parent,
                     const std::string& name,
                     std::uint64_t value) {
  put(parent, name, H5T_STD_U64LE, &value);
}

void remove_attribute(hid_t parent, const std::string& name) {
  if (has_attribute(parent, name))
    check(H5Adelete(parent, name.c_str()), "remove attribute " + name);
}

bool has_attribute(hid_t parent, const std::string& name) {
  return H5Aexists(parent, name.c_str()) > 0;
}

std::string read_attribute(hid_t parent, const std::string& name) {
  const Handle attribute = open(parent, name);
  const Handle type(H5Aget_type(attribute), H5Tclose, "read a text type");
  // It would be a pointer to a text of variable length.
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 ||
      !is_scalar(attribute) || H5Tget_size(type) > kLongestText)
    throw StoreError(
        fmt::format("attribute {} is not one text of fixed length", name));
  std::string value(H5Tget_size(type), '\0');
  check(H5Aread(attribute, type, value.data()), "read attribute " + name);
  return value.c_str();  // without the closing zero
}

std::uint64_t read_number(hid_t parent, const std::string& name) {
  const Handle attribute = open(parent, name);
  const Handle type(H5Aget_type(attribute), H5Tclose, "read a type");
  if (H5Tget_class(type) != H5T_INTEGER || !is_scalar(attribute))
    throw StoreError(fmt::format("attribute {} is not one whole number", name));
  std::uint64_t value = 0;
  check(H5Aread(attribute, H5T_NATIVE_UINT64, &value),
        "read attribute " + name);
  return value;
}

}  // namespace physinv::hdf5
