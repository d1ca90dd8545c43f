/// A directory that holds what the suite makes, such as a store. Its files are
/// reached through it, wherever its name points now, and no link in it is
/// followed: what is outside is not touched.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "suite/store/file.h"

namespace physinv {

class Folder {
 public:
  Folder() = default;
  /// Must be there; its own name may be a link.
  explicit Folder(const std::filesystem::path& directory);

  const std::filesystem::path& path() const { return path_; }

  /// A folder in it, if there is one; StoreError for a link or a file.
  std::optional<Folder> find(const std::string& name) const;
  /// The same, made if there is none.
  Folder make(const std::string& name) const;
  /// A new one of a name that only the suite makes.
  Folder make_new() const;

  /// Is there anything of this name?
  bool has(const std::string& name) const;
  std::vector<std::string> names() const;

  /// A regular file, without waiting; StoreError for anything else.
  FileDescriptor open(const std::string& name,
                      int flags,
                      std::string_view what) const;
  std::string read(const std::string& name, std::uint64_t limit) const;
  /// Writes aside, syncs, renames, syncs the directory: whatever happens, the
  /// file holds either the old bytes or the new. Replaces regular files only.
  void write(const std::string& name, std::string_view bytes) const;
  /// Writes a new file; false if there is anything of this name.
  bool create(const std::string& name, std::string_view bytes) const;
  /// A regular file; nothing is done if there is none.
  void remove(const std::string& name) const;
  /// Only if these are its bytes; true if so.
  bool remove_if(const std::string& name, std::string_view bytes) const;
  /// Folders are removed if nothing is left in them.
  void remove_empty(const std::string& name) const;

  /// Removes files aside that a killed writer left.
  void remove_leftovers() const;

 private:
  friend class FileGroup;
  /// A new file in the folder of `name`, which it may replace: its name, and
  /// itself open.
  std::pair<std::string, FileDescriptor> write_aside(
      const std::string& name, std::string_view bytes) const;
  void put_in_place(const std::string& aside, const std::string& name) const;
  void drop(const std::string& aside) const noexcept;
  void sync_names() const;

  FileDescriptor fd_;
  std::filesystem::path path_;
};

/// Files of a folder that are replaced together: each holds either the old
/// bytes or the new, and all of them are on disk for the price of one.
class FileGroup {
 public:
  explicit FileGroup(const Folder& folder) : folder_(folder) {}
  /// What was not put in place is removed.
  ~FileGroup();
  FileGroup(const FileGroup&) = delete;
  FileGroup& operator=(const FileGroup&) = delete;

  /// Writes aside. Replaces regular files only.
  void add(const std::string& name, std::string_view bytes);
  /// One sync for all contents, one for all names.
  void put_in_place();

 private:
  void sync_contents() const;

  const Folder& folder_;
  std::vector<std::pair<std::string, std::string>> files_;  ///< aside, name
};

/// A name that `Folder` gives to files aside, or to new folders.
bool is_aside_file(std::string_view name);
bool is_new_folder(std::string_view name);

}  // namespace physinv
