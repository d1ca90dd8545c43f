/// HDF5 handles, and files that live in memory until they are complete.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/stop.h"

namespace physinv::hdf5 {

/// Owns an identifier of any kind.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  /// Throws StoreError with HDF5's reason if `id` is not valid.
  Handle(hid_t id, Close close, std::string_view what);
  Handle(Handle&& o) noexcept
      : id_(std::exchange(o.id_, -1)), close_(o.close_) {}
  Handle& operator=(Handle&& o) noexcept {
    std::swap(id_, o.id_), std::swap(close_, o.close_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }  // NOLINT: passed to the C functions

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// Throws StoreError with HDF5's reason if `result` is negative.
void check(herr_t result, std::string_view what);

/// An empty file in memory, or one with these bytes; StoreError if they are of
/// another form than what is written here (hdf5_form.h).
Handle new_file();
Handle open_image(std::string bytes);
/// The bytes that would be on disk.
std::string image(const Handle& file);

Handle create_group(hid_t parent, const std::string& name);
Handle open_group(hid_t parent, const std::string& name);
bool has(hid_t parent, const std::string& name);
void remove(hid_t parent, const std::string& name);
std::vector<std::string> names(hid_t group);

/// What an array is, as attributes of it; empty ones are left out.
struct Note {
  std::string axes = {};   ///< "samples,unknowns"
  std::string unit = {};   ///< "s"
  std::string names = {};  ///< of what its last axis counts
};

/// Matrices are stored as (columns, rows) arrays: the bytes of a batch.
void write(hid_t parent,
           const std::string& name,
           const Batch<double>& value,
           const Note& note = {});
void write(hid_t parent,
           const std::string& name,
           const std::vector<double>& value,
           const Note& note = {});
/// As whole numbers of 32 bits, which every reader has. Their words are in the
/// attributes flag_values and flag_meanings, as in the CF conventions.
void write(hid_t parent,
           const std::string& name,
           const std::vector<Status>& value,
           const Note& note = {});
/// The same bytes as (columns, parts, rows / parts).
void write_cube(hid_t parent,
                const std::string& name,
                const Batch<double>& value,
                Index parts,
                const Note& note = {});

/// What describes an array.
Note note(hid_t parent, const std::string& name);
/// How many axes an array has.
int rank(hid_t parent, const std::string& name);
/// What is read has the type and rank that it was written with, and all its
/// bytes are there; StoreError if not.
Batch<double> read_batch(hid_t parent, const std::string& name);
std::vector<double> read_list(hid_t parent, const std::string& name);
Batch<double> read_cube(hid_t parent, const std::string& name);
/// The numbers of statuses; older files have them as bytes or an enumeration.
std::vector<std::int32_t> read_codes(hid_t parent, const std::string& name);

/// One text, or one whole number, of a name that is free. A text has its exact
/// length, without a zero at its end; it is UTF-8, and ASCII where it can be.
/// An attribute holds less than 64 KiB: of a longer text the first 60,000 bytes
/// or less, in whole characters, have the name, the next ones name_2, name_3
/// and so on.
void write_attribute(hid_t parent,
                     const std::string& name,
                     const std::string& value);
void write_attribute(hid_t parent,
                     const std::string& name,
                     std::uint64_t value);
/// A list of whole numbers of 32 bits.
void write_attribute(hid_t parent,
                     const std::string& name,
                     const std::vector<std::int32_t>& value);
/// Nothing is done if there is none.
void remove_attribute(hid_t parent, const std::string& name);
bool has_attribute(hid_t parent, const std::string& name);
/// All parts of a text, up to the first zero of each; StoreError for what is
/// anything else.
std::string read_attribute(hid_t parent, const std::string& name);
std::uint64_t read_number(hid_t parent, const std::string& name);

}  // namespace physinv::hdf5
