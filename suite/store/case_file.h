/// The arrays of one case, in one HDF5 file.
///
///   /                                           what the case is
///   /data/{x, y, given}                         hash
///   /stages/<position>_<stage>/{x, loss, status, iterations, evaluations}
///                             /curve/{iteration, seconds, evaluations, loss,
///                                     x}
///                             /arrays/<name>    key, hash, how it ran
///
/// with attributes on the right; arrays have their axes, unit and names.
/// docs/data.md lists all of them. Examples are the first axis, points of a
/// curve are. Version 1 had no attributes but case, hash and key, and other
/// shapes; version 2 had statuses as an enumeration, and texts that end in a
/// zero. Both are read, and written again once a stage is added.
///
/// What is read back has the types, shapes and hashes that it was written
/// with. All of the data is finite, and a stage's arrays are what storable.h
/// says.
///
/// Sixteen bytes after the end of the HDF5
/// data hold a checksum of the whole file; HDF5 tools do not mind them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "suite/store/folder.h"
#include "suite/store/hdf5.h"
#include "suite/store/record.h"

namespace physinv {

/// Of the case's file. 2: attributes that describe it, examples first. 3:
/// statuses are whole numbers, texts have their exact length.
inline constexpr std::uint64_t kCaseVersion = 3;

/// File name of a case: its name with '+' for '/', and .h5.
std::string case_file_name(const std::string& case_name);

/// Hash of everything in the arrays that another run must reproduce.
std::uint64_t results_hash(const StageRecord& record);
/// The same with the times of the curve.
std::uint64_t arrays_hash(const StageRecord& record);

class CaseFile {
 public:
  /// An empty one, in memory.
  explicit CaseFile(const std::string& case_name);
  /// Reads and verifies what is in the folder of case files; StoreError if it
  /// is missing, damaged or of another case.
  CaseFile(const Folder& folder, const std::string& case_name);
  /// The same of a file's bytes; `path` is for messages.
  CaseFile(std::string bytes,
           const std::filesystem::path& path,
           const std::string& case_name);

  /// What the case is, with the run of its latest stage; comes first.
  void describe(const CaseInfo& info, const StageRecord& latest);
  /// What `describe` wrote.
  About about() const;

  void put_data(const CaseData& data);
  /// StoreError, with the array's name, unless all of it has the hash.
  CaseData data() const;

  /// Replaces what is stored at the record's position. `hash` is
  /// arrays_hash(record).
  void put_stage(const StageRecord& record, const std::string& hash);
  /// True if the arrays of this key and with this hash are there.
  bool has_stage(const StageRecord& record, const std::string& hash) const;
  /// Fills in the arrays of a record; StoreError if they lack the hash.
  void read_stage(StageRecord& record, const std::string& hash) const;

  /// The whole file, as it is on disk.
  std::string bytes() const;
  void save(const Folder& folder) const;

 private:
  template <class F>
  auto named(F&& body) const;
  CaseData read_data() const;
  void describe_case(const CaseInfo& info) const;
  void put_arrays(const hdf5::Handle& group, const StageRecord& record) const;
  void renew();

  hdf5::Handle file_;
  std::string case_name_;
  About about_;
  bool data_are_sound_ = false;  ///< written here, or looked at
  std::string where_;            ///< for messages
};

}  // namespace physinv
