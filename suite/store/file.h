/// Files that are either complete and on disk, or not there. Those of a store
/// are reached through its folder, see folder.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "suite/store/errors.h"

namespace physinv {

/// What is larger is not read: a document, which takes some twenty times its
/// size in memory, and lines or arrays. Nothing the suite writes comes near.
inline constexpr std::uint64_t kLargestText = std::uint64_t{32} << 20;
inline constexpr std::uint64_t kLargestData = std::uint64_t{512} << 20;

/// Throws StoreError "cannot <what> <path>: <reason> (<what to do>)".
[[noreturn]] void fail_file(std::string_view what,
                            const std::filesystem::path& path,
                            int error_number);
/// The same for what is "a link", "a FIFO" and so on, and no `wanted`.
[[noreturn]] void fail_kind(std::string_view what,
                            const std::filesystem::path& path,
                            unsigned mode,
                            std::string_view wanted = "a file");

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
/// All of a regular file; StoreError if it is anything else, or has more bytes
/// than `limit`.
std::string read_all(const FileDescriptor& fd,
                     const std::filesystem::path& path,
                     std::uint64_t limit);

/// Data and size are on disk when it returns.
void sync(const FileDescriptor& fd, const std::filesystem::path& path);

/// For a file that a user names: links are followed. Whatever happens, it
/// holds either the old bytes or the new. What is there and no regular file
/// (a terminal, a pipe, /dev/null) is written into as it is.
void write_atomically(const std::filesystem::path& path,
                      std::string_view bytes);
/// Adds to what others write there, too.
void append_to(const std::filesystem::path& path, std::string_view bytes);

/// Whether a path leads to a file, a folder, or anything; links are followed.
/// Not if that cannot be found out, as of a name that is too long.
bool is_file(const std::filesystem::path& path);
bool is_folder(const std::filesystem::path& path);
bool is_there(const std::filesystem::path& path);

/// Of a file that a user names, or of one that the suite makes.
std::string read_file(const std::filesystem::path& path,
                      std::uint64_t limit = kLargestText);

/// In gzip's format, without name and time: same bytes in, same bytes out.
std::string gzipped(std::string_view bytes);
/// Of one such file; runtime_error if it is damaged or gives more than `limit`.
std::string gunzipped(std::string_view bytes,
                      std::uint64_t limit = kLargestText);

/// Creates it and its parents, durably enough for a store.
void make_directory(const std::filesystem::path& directory);

}  // namespace physinv
