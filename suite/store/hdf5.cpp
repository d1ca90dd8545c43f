#include "suite/store/hdf5.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <iterator>
#include <span>

#include "suite/store/errors.h"
#include "suite/store/fields.h"
#include "suite/store/hdf5_form.h"

namespace physinv::hdf5 {
namespace {

/// Description of the innermost error on HDF5's stack.
std::string reason() {
  std::string text;
  H5Ewalk2(
      H5E_DEFAULT,
      H5E_WALK_UPWARD,
      [](unsigned n, const H5E_error2_t* e, void* out) -> herr_t {
        if (n == 0 && e->desc != nullptr)
          *static_cast<std::string*>(out) = e->desc;
        return 0;
      },
      &text);
  return text.empty() ? "unknown reason" : text;
}

[[noreturn]] void fail(std::string_view what) {
  throw StoreError(fmt::format("HDF5 cannot {}: {}", what, reason()));
}

/// HDF5 prints its errors unless told not to.
void be_quiet() {
  static const herr_t done = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  static_cast<void>(done);
}

Handle memory_access() {
  be_quiet();
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make a property list");
  check(H5Pset_fapl_core(access, 1 << 18, false), "use memory");
  // The form that is checked when it is read.
  check(H5Pset_libver_bounds(access, H5F_LIBVER_EARLIEST, H5F_LIBVER_LATEST),
        "choose a form");
  return access;
}

/// HDF5 takes files of one name for one file, also in memory.
std::string unique_name() {
  static std::atomic<unsigned> next{0};
  return fmt::format("memory-{}", next++);
}

void write_note(const Handle& set, const Note& note) {
  for (const auto& [key, text] : {std::pair("axes", &note.axes),
                                  {"unit", &note.unit},
                                  {"names", &note.names}})
    if (!text->empty()) write_attribute(set, key, *text);
}

Handle write_array(hid_t parent,
                   const std::string& name,
                   std::span<const hsize_t> shape,
                   hid_t type,
                   const void* data,
                   const Note& note) {
  const Handle space(
      H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
      H5Sclose,
      "make a shape");
  const Handle options(
      H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make a property list");
  check(H5Pset_obj_track_times(options, false), "leave out times");
  Handle set(
      H5Dcreate2(
          parent, name.c_str(), type, space, H5P_DEFAULT, options, H5P_DEFAULT),
      H5Dclose,
      "create array " + name);
  if (std::find(shape.begin(), shape.end(), 0) == shape.end())
    check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data),
          "write array " + name);
  write_note(set, note);
  return set;
}

/// The enumeration of Status, as version 2 stored it.
hid_t status_type() {
  static const Handle type = [] {
    Handle names(H5Tenum_create(H5T_STD_U8LE), H5Tclose, "make a type");
    for (const Status s : {Status::gtol,
                           Status::maxiter,
                           Status::linesearch,
                           Status::nonfinite}) {
      const auto value = static_cast<std::uint8_t>(s);
      check(H5Tenum_insert(names, to_string(s).data(), &value), "make a type");
    }
    return names;
  }();
  return type;
}

/// A name may stand for something elsewhere, also in another file.
void require_own(hid_t parent, const std::string& name) {
  H5L_info_t info;
  check(H5Lget_info(parent, name.c_str(), &info, H5P_DEFAULT), "find " + name);
  if (info.type != H5L_TYPE_HARD)
    throw StoreError(fmt::format("{} is a link to another file", name));
}

/// As the suite writes them: one block in this file, without filters, which
/// HDF5 would load programs for.
void require_plain(const Handle& set, const std::string& name) {
  const Handle made(
      H5Dget_create_plist(set), H5Pclose, "read how it is stored: " + name);
  const H5D_layout_t layout = H5Pget_layout(made);
  if ((layout != H5D_CONTIGUOUS && layout != H5D_COMPACT) ||
      H5Pget_external_count(made) != 0 || H5Pget_nfilters(made) != 0)
    throw StoreError(fmt::format(
        "array {} has another storage layout than this program writes", name));
}

Handle open_array(hid_t parent, const std::string& name) {
  require_own(parent, name);
  Handle set(H5Dopen2(parent, name.c_str(), H5P_DEFAULT),
             H5Dclose,
             "open array " + name);
  require_plain(set, name);
  return set;
}

hsize_t file_size(hid_t object) {
  const Handle file(H5Iget_file_id(object), H5Fclose, "find the file");
  hsize_t size = 0;
  check(H5Fget_filesize(file, &size), "tell the size of the file");
  return size;
}

/// A shape is only a claim: nothing is allocated for bytes that are not there.
bool holds_all(const Handle& set,
               std::size_t element,
               const std::vector<hsize_t>& shape) {
  constexpr hsize_t kLongest = hsize_t{1} << 40;
  hsize_t bytes = element;
  for (const hsize_t count : shape)
    if (count > kLongest || __builtin_mul_overflow(bytes, count, &bytes))
      return false;
  return bytes == H5Dget_storage_size(set) && bytes <= file_size(set);
}

std::vector<hsize_t> shape_of(const Handle& set,
                              int rank,
                              bool real,
                              const std::string& name) {
  const Handle space(H5Dget_space(set), H5Sclose, "read shape of " + name);
  const Handle type(H5Dget_type(set), H5Tclose, "read type of " + name);
  const H5T_class_t numbers = H5Tget_class(type);
  const bool good =
      real ? numbers == H5T_FLOAT
           : numbers == H5T_INTEGER || H5Tequal(type, status_type()) > 0;
  if (!good)
    throw StoreError(fmt::format(
        "array {} does not contain {} numbers", name, real ? "real" : "whole"));
  if (H5Sget_simple_extent_ndims(space) != rank)
    throw StoreError(
        fmt::format("array {} does not have {} dimensions", name, rank));
  std::vector<hsize_t> shape(static_cast<std::size_t>(rank));
  check(H5Sget_simple_extent_dims(space, shape.data(), nullptr),
        "read shape of " + name);
  if (!holds_all(set, H5Tget_size(type), shape))
    throw StoreError(fmt::format("array {} is incomplete", name));
  return shape;
}

void read_array(const Handle& set,
                hid_t memory,
                void* data,
                bool empty,
                const std::string& name) {
  if (!empty)
    check(H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data),
          "read array " + name);
}

}  // namespace

Handle::Handle(hid_t id, Close close, std::string_view what)
    : id_(id), close_(close) {
  if (id_ < 0) fail(what);
}

void check(herr_t result, std::string_view what) {
  if (result < 0) fail(what);
}

Handle new_file() {
  const Handle access = memory_access();
  return {H5Fcreate(unique_name().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access),
          H5Fclose,
          "create a file"};
}

Handle open_image(std::string bytes) {
  check_form(bytes);
  const Handle access = memory_access();
  check(H5Pset_file_image(access, bytes.data(), bytes.size()), "use memory");
  return {H5Fopen(unique_name().c_str(), H5F_ACC_RDWR, access),
          H5Fclose,
          "open the file"};
}

std::string image(const Handle& file) {
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), "flush the file");
  const auto size = H5Fget_file_image(file, nullptr, 0);
  if (size < 0) fail("tell the size of the file");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size)
    fail("copy the file");
  return bytes;
}

Handle create_group(hid_t parent, const std::string& name) {
  return {
      H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Gclose,
      "create group " + name};
}

Handle open_group(hid_t parent, const std::string& name) {
  require_own(parent, name);
  return {H5Gopen2(parent, name.c_str(), H5P_DEFAULT),
          H5Gclose,
          "open group " + name};
}

bool has(hid_t parent, const std::string& name) {
  return H5Lexists(parent, name.c_str(), H5P_DEFAULT) > 0;
}

void remove(hid_t parent, const std::string& name) {
  check(H5Ldelete(parent, name.c_str(), H5P_DEFAULT), "remove " + name);
}

std::vector<std::string> names(hid_t group) {
  std::vector<std::string> all;
  check(
      H5Literate(
          group,
          H5_INDEX_NAME,
          H5_ITER_INC,
          nullptr,
          [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
            static_cast<std::vector<std::string>*>(out)->emplace_back(name);
            return 0;
          },
          &all),
      "list a group");
  return all;
}

void write(hid_t parent,
           const std::string& name,
           const Batch<double>& v,
           const Note& note) {
  const hsize_t shape[] = {static_cast<hsize_t>(v.cols()),
                           static_cast<hsize_t>(v.rows())};
  write_array(parent, name, shape, H5T_IEEE_F64LE, v.data(), note);
}

void write(hid_t parent,
           const std::string& name,
           const std::vector<double>& v,
           const Note& note) {
  const hsize_t shape[] = {v.size()};
  write_array(parent, name, shape, H5T_IEEE_F64LE, v.data(), note);
}

void write(hid_t parent,
           const std::string& name,
           const std::vector<Status>& v,
           const Note& note) {
  const auto code = [](Status s) { return static_cast<std::int32_t>(s); };
  std::vector<std::int32_t> codes, values;
  std::transform(v.begin(), v.end(), std::back_inserter(codes), code);
  const hsize_t shape[] = {codes.size()};
  const Handle set =
      write_array(parent, name, shape, H5T_STD_I32LE, codes.data(), note);
  std::vector<std::string_view> words;
  for (const Status s : kValues<Status>)
    values.push_back(code(s)), words.push_back(to_string(s));
  write_attribute(set, "flag_values", values);
  write_attribute(
      set, "flag_meanings", fmt::format("{}", fmt::join(words, " ")));
}

void write_cube(hid_t parent,
                const std::string& name,
                const Batch<double>& v,
                Index parts,
                const Note& note) {
  const hsize_t shape[] = {static_cast<hsize_t>(v.cols()),
                           static_cast<hsize_t>(parts),
                           static_cast<hsize_t>(v.rows() / parts)};
  write_array(parent, name, shape, H5T_IEEE_F64LE, v.data(), note);
}

Note note(hid_t parent, const std::string& name) {
  const Handle set = open_array(parent, name);
  Note note;
  for (const auto& [key, text] : {std::pair("axes", &note.axes),
                                  {"unit", &note.unit},
                                  {"names", &note.names}})
    if (has_attribute(set, key)) *text = read_attribute(set, key);
  return note;
}

int rank(hid_t parent, const std::string& name) {
  const Handle set = open_array(parent, name);
  const Handle space(H5Dget_space(set), H5Sclose, "read shape of " + name);
  return H5Sget_simple_extent_ndims(space);
}

Batch<double> read_batch(hid_t parent, const std::string& name) {
  const Handle set = open_array(parent, name);
  const auto shape = shape_of(set, 2, true, name);
  Batch<double> v(static_cast<Index>(shape[1]), static_cast<Index>(shape[0]));
  read_array(set, H5T_NATIVE_DOUBLE, v.data(), v.size() == 0, name);
  return v;
}

Batch<double> read_cube(hid_t parent, const std::string& name) {
  const Handle set = open_array(parent, name);
  const auto shape = shape_of(set, 3, true, name);
  Batch<double> v(static_cast<Index>(shape[1] * shape[2]),
                  static_cast<Index>(shape[0]));
  read_array(set, H5T_NATIVE_DOUBLE, v.data(), v.size() == 0, name);
  return v;
}

std::vector<double> read_list(hid_t parent, const std::string& name) {
  const Handle set = open_array(parent, name);
  std::vector<double> v(shape_of(set, 1, true, name)[0]);
  read_array(set, H5T_NATIVE_DOUBLE, v.data(), v.empty(), name);
  return v;
}

std::vector<std::int32_t> read_codes(hid_t parent, const std::string& name) {
  const Handle set = open_array(parent, name);
  const hsize_t count = shape_of(set, 1, false, name)[0];
  const Handle type(H5Dget_type(set), H5Tclose, "read type of " + name);
  if (H5Tget_class(type) == H5T_ENUM) {
    std::vector<std::uint8_t> bytes(count);
    read_array(set, type, bytes.data(), count == 0, name);
    return {bytes.begin(), bytes.end()};
  }
  std::vector<std::int32_t> v(count);
  read_array(set, H5T_NATIVE_INT32, v.data(), count == 0, name);
  return v;
}

}  // namespace physinv::hdf5
