#include <fmt/format.h>

#include <algorithm>

#include "suite/store/errors.h"
#include "suite/store/hdf5.h"

namespace physinv::hdf5 {
namespace {

/// What fits into the header of an object, where attributes are stored.
constexpr std::size_t kLongestText = 1 << 16;
/// The same, next to a name and a type.
constexpr std::size_t kLongestPart = 60000;

hid_t scalar() {
  static const Handle shape(H5Screate(H5S_SCALAR), H5Sclose, "make a shape");
  return shape;
}

void put(hid_t parent,
         const std::string& name,
         hid_t type,
         hid_t shape,
         const void* value) {
  const Handle attribute(
      H5Acreate2(parent, name.c_str(), type, shape, H5P_DEFAULT, H5P_DEFAULT),
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

/// The name of a part of a text; 0 is the first.
std::string part_name(const std::string& name, std::size_t part) {
  return part == 0 ? name : fmt::format("{}_{}", name, part + 1);
}

bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }

/// How many bytes of a text the next part takes: no character is cut in two.
std::size_t part_size(std::string_view text) {
  if (text.size() <= kLongestPart) return text.size();
  std::size_t size = kLongestPart;
  for (int k = 0; k < 3; ++k)
    if ((static_cast<unsigned char>(text[size]) & 0xc0U) == 0x80U) --size;
  return size;
}

/// HDF5 has no texts of no bytes: an empty one is a zero.
void put_text(hid_t parent, const std::string& name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a text type");
  check(H5Tset_size(type, std::max<std::size_t>(1, text.size())),
        "make a text type");
  check(H5Tset_strpad(type, H5T_STR_NULLPAD), "make a text type");
  if (!std::all_of(text.begin(), text.end(), is_ascii))
    check(H5Tset_cset(type, H5T_CSET_UTF8), "make a text type");
  put(parent, name, type, scalar(), text.c_str());
}

std::string read_part(hid_t parent, const std::string& name) {
  const Handle attribute = open(parent, name);
  const Handle type(H5Aget_type(attribute), H5Tclose, "read a text type");
  // It would be a pointer to a text of variable length.
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 ||
      !is_scalar(attribute) || H5Tget_size(type) > kLongestText)
    throw StoreError(
        fmt::format("attribute {} is not one text of fixed length", name));
  std::string value(H5Tget_size(type), '\0');
  check(H5Aread(attribute, type, value.data()), "read attribute " + name);
  return value.c_str();  // without the zeros at its end
}

}  // namespace

void write_attribute(hid_t parent,
                     const std::string& name,
                     const std::string& value) {
  std::size_t at = 0, part = 0;
  do {
    const std::size_t size = part_size(std::string_view(value).substr(at));
    put_text(parent, part_name(name, part++), value.substr(at, size));
    at += size;
  } while (at < value.size());
}

void write_attribute(hid_t parent,
                     const std::string& name,
                     std::uint64_t value) {
  put(parent, name, H5T_STD_U64LE, scalar(), &value);
}

void write_attribute(hid_t parent,
                     const std::string& name,
                     const std::vector<std::int32_t>& value) {
  const hsize_t count = value.size();
  const Handle shape(
      H5Screate_simple(1, &count, nullptr), H5Sclose, "make a shape");
  put(parent, name, H5T_STD_I32LE, shape, value.data());
}

void remove_attribute(hid_t parent, const std::string& name) {
  for (std::size_t part = 0;; ++part) {
    const std::string own = part_name(name, part);
    if (!has_attribute(parent, own)) return;
    check(H5Adelete(parent, own.c_str()), "remove attribute " + own);
  }
}

bool has_attribute(hid_t parent, const std::string& name) {
  return H5Aexists(parent, name.c_str()) > 0;
}

std::string read_attribute(hid_t parent, const std::string& name) {
  std::string value = read_part(parent, name);
  for (std::size_t part = 1; has_attribute(parent, part_name(name, part));
       ++part)
    value += read_part(parent, part_name(name, part));
  return value;
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
