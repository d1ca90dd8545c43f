/// What can be wrong with a store on disk. Messages are one line: what, which
/// file, why, what to do.
#pragma once

#include <stdexcept>

namespace physinv {

/// The disk or the directory does not let us, or a file is damaged.
class StoreError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A damaged line in the journal that is not a torn last one.
class CorruptJournal : public StoreError {
 public:
  using StoreError::StoreError;
};

/// Intact, but not for this program or not for this purpose: a newer schema,
/// no results at all, shards of different campaigns.
class UnreadableInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace physinv
