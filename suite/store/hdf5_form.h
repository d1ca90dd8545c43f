/// The part of HDF5's file format that this suite writes: groups by symbol
/// tables, arrays in one piece of doubles or statuses, attributes of one text,
/// whole number or the numbers of all statuses (HDF5 File Format Specification
/// 2.0, superblock version 0). In older files statuses are bytes or an
/// enumeration, and texts end in a zero.
#pragma once

#include <string_view>

namespace physinv::hdf5 {

/// StoreError unless the bytes of a file are of that form throughout. The
/// library itself trusts much of what a file says of itself, and would follow
/// it to other files, by links, external storage and filters.
void check_form(std::string_view image);

}  // namespace physinv::hdf5
