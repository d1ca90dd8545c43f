/// Files that are either complete and on disk, or not there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "suite/results/errors.h"

namespace physinv {

/// Throws StoreError "cannot <what> <path>: <reason> (<what to do>)".
[[noreturn]] void fail_file(std::string_view what,
                            const std::filesystem::path& path,
                            int error_number);

/// Owns a file descriptor.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(FileDescriptor&& o) noexcept : fd_(std::exchange(o.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& o) noexcept {
    std::swap(fd_, o.fd_);
    return *this;
  }
  ~FileDescriptor();
  int get() const { return fd_; }

 private:
  int fd_ = -1;
};

/// Writes all of it at the descriptor's position.
void write_all(const FileDescriptor& fd,
               std::string_view bytes,
               const std::filesystem::path& path);

/// Data and size are on disk when it returns.
void sync(const FileDescriptor& fd, const std::filesystem::path& path);
/// So are names made or removed in a directory.
void sync_directory(const std::filesystem::path& directory);

/// Writes aside (`path`.tmp), syncs, renames, syncs the directory: whatever
/// happens, `path` holds either the old bytes or the new.
void write_atomically(const std::filesystem::path& path,
                      std::string_view bytes);

std::string read_file(const std::filesystem::path& path);

/// In gzip's format, without name and time: same bytes in, same bytes out.
std::string gzipped(std::string_view bytes);

/// Creates it and its parents, durably enough for a store.
void make_directory(const std::filesystem::path& directory);

/// Held while somebody writes to a directory. Dies with its process; a forked
/// child keeps it too.
class DirectoryLock {
 public:
  DirectoryLock() = default;
  /// Throws StoreError if another process holds it.
  explicit DirectoryLock(const std::filesystem::path& directory);

 private:
  FileDescriptor fd_;
};

}  // namespace physinv
