#include "suite/store/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <optional>

#include "suite/store/folder.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

constexpr int kGzip = 15 + 16;  // zlib's largest window, gzip's header

std::string_view advice(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
      return "free some space or choose another --out; finished stages are "
             "saved";
    case EFBIG:
      return "raise the limit on file sizes (ulimit -f); finished stages are "
             "saved";
    case EACCES:
    case EPERM:
      return "allow this user to write there or choose another --out";
    case EROFS:
      return "choose an --out on a file system that is not read-only";
    case ENOENT:
    case ENOTDIR:
    case EEXIST:
      return "check the path";
    default:
      return "check the disk or choose another --out";
  }
}

/// Retries what a signal interrupted.
template <class F>
auto retry(F&& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

std::optional<struct stat> file_info(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) < 0) return {};
  return info;
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

std::string_view kind(unsigned mode) {
  switch (mode & S_IFMT) {
    case S_IFLNK:
      return "a link";
    case S_IFDIR:
      return "a directory";
    case S_IFIFO:
      return "a FIFO";
    case S_IFSOCK:
      return "a socket";
    case S_IFREG:
      return "a file";
    default:
      return "a device";
  }
}

FileDescriptor open_file(const fs::path& path,
                         int flags,
                         std::string_view what) {
  flags |= O_CLOEXEC | O_NOCTTY | O_NONBLOCK;
  FileDescriptor fd(retry([&] { return ::open(path.c_str(), flags, 0644); }));
  if (fd.get() >= 0) return fd;
  const int error = errno;
  if (const auto info = file_info(path);
      error == ENXIO && info && S_ISSOCK(info->st_mode))
    fail_kind(what, path, info->st_mode);
  fail_file(what, path, error);
}

/// Where links lead to in the end, whether it is there or not. /proc's own,
/// to what a process has open, are no paths.
fs::path followed(fs::path path) {
  std::error_code error;
  for (int links = 0; links < 40; ++links) {
    const fs::path target = fs::read_symlink(path, error);
    if (error ||
        fs::canonical(folder_of(path), error).native().starts_with("/proc/"))
      return path;
    path = folder_of(path) / target;
  }
  return path;
}

/// The descriptor of this process that /dev/stdout, /dev/fd/3 and the like
/// stand for; its position counts, not that of a file opened again.
FileDescriptor own_descriptor(const fs::path& path) {
  std::error_code error;
  const auto own = fs::path("/proc") / std::to_string(::getpid()) / "fd";
  if (fs::canonical(folder_of(path), error) != own) return {};
  const std::string name = path.filename();
  if (name.find_first_not_of("0123456789") != std::string::npos) return {};
  std::fflush(nullptr);  // what was printed before comes first
  return FileDescriptor(::fcntl(std::atoi(name.c_str()), F_DUPFD_CLOEXEC, 0));
}

/// Waits for a slow reader, but not for one that may never come.
void write_into(const FileDescriptor& fd,
                std::string_view bytes,
                const fs::path& path) {
  ::fcntl(fd.get(), F_SETFL, ::fcntl(fd.get(), F_GETFL) & ~O_NONBLOCK);
  write_all(fd, bytes, path);
}

}  // namespace

void fail_file(std::string_view what, const fs::path& path, int error_number) {
  throw StoreError(fmt::format("cannot {} {}: {} ({})",
                               what,
                               path.string(),
                               std::strerror(error_number),
                               advice(error_number)));
}

void fail_kind(std::string_view what,
               const fs::path& path,
               unsigned mode,
               std::string_view wanted) {
  throw StoreError(fmt::format(
      "cannot {} {}: it is {}, not {} (move it away or choose another path)",
      what,
      path.string(),
      kind(mode),
      wanted));
}

FileDescriptor::~FileDescriptor() {
  if (fd_ >= 0) ::close(fd_);
}

void write_all(const FileDescriptor& fd,
               std::string_view bytes,
               const fs::path& path) {
  while (!bytes.empty()) {
    const auto n =
        retry([&] { return ::write(fd.get(), bytes.data(), bytes.size()); });
    if (n < 0) fail_file("write", path, errno);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

void sync(const FileDescriptor& fd, const fs::path& path) {
  if (retry([&] { return ::fdatasync(fd.get()); }) < 0)
    fail_file("write", path, errno);
}

void write_atomically(const fs::path& named, std::string_view bytes) {
  const fs::path path = followed(named);
  if (const auto own = own_descriptor(path); own.get() >= 0)
    return write_all(own, bytes, named);
  const auto info = file_info(path);
  if (info && S_ISDIR(info->st_mode)) fail_kind("write", named, info->st_mode);
  if (info && !S_ISREG(info->st_mode))
    return write_into(open_file(path, O_WRONLY, "write"), bytes, named);
  Folder(folder_of(path)).write(path.filename(), bytes);
}

void append_to(const fs::path& path, std::string_view bytes) {
  write_into(
      open_file(path, O_WRONLY | O_APPEND | O_CREAT, "write"), bytes, path);
}

std::string read_all(const FileDescriptor& fd,
                     const fs::path& path,
                     std::uint64_t limit) {
  struct stat info {};
  if (::fstat(fd.get(), &info) < 0) fail_file("read", path, errno);
  if (!S_ISREG(info.st_mode)) fail_kind("read", path, info.st_mode);
  const auto size = static_cast<std::uint64_t>(info.st_size);
  if (size > limit)
    throw StoreError(
        fmt::format("cannot read {}: it has {} bytes, the limit is {} (restore "
                    "it or choose another path)",
                    path.string(),
                    size,
                    limit));
  std::string bytes(size, '\0');
  std::size_t used = 0;
  while (used < bytes.size()) {
    const auto n = retry([&] {
      return ::read(fd.get(), bytes.data() + used, bytes.size() - used);
    });
    if (n < 0) fail_file("read", path, errno);
    if (n == 0) break;
    used += static_cast<std::size_t>(n);
  }
  bytes.resize(used);
  return bytes;
}

bool is_file(const std::filesystem::path& path) {
  std::error_code unknown;
  return std::filesystem::is_regular_file(path, unknown);
}

bool is_folder(const std::filesystem::path& path) {
  std::error_code unknown;
  return std::filesystem::is_directory(path, unknown);
}

bool is_there(const std::filesystem::path& path) {
  std::error_code unknown;
  return std::filesystem::exists(path, unknown);
}

std::string read_file(const fs::path& path, std::uint64_t limit) {
  return read_all(open_file(path, O_RDONLY, "read"), path, limit);
}

std::string gzipped(std::string_view bytes) {
  z_stream z{};
  if (deflateInit2(&z, 9, Z_DEFLATED, kGzip, 9, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string out(deflateBound(&z, bytes.size()), '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  const int end = deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  if (end != Z_STREAM_END) throw std::runtime_error("cannot compress");
  return out;
}

std::string gunzipped(std::string_view bytes, std::uint64_t limit) {
  z_stream z{};
  if (inflateInit2(&z, kGzip) != Z_OK) throw std::bad_alloc();
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  std::string out;
  int end = Z_OK;
  while (end == Z_OK && out.size() < limit) {
    constexpr std::size_t kStep = 1 << 20;
    out.resize(std::min<std::uint64_t>(out.size() + kStep, limit));
    z.next_out = reinterpret_cast<Bytef*>(out.data() + z.total_out);
    z.avail_out = static_cast<uInt>(out.size() - z.total_out);
    end = inflate(&z, Z_NO_FLUSH);
  }
  out.resize(z.total_out);
  const bool all = end == Z_STREAM_END && z.avail_in == 0;
  inflateEnd(&z);
  if (!all) throw std::runtime_error("it is damaged, or too long");
  return out;
}

void make_directory(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) fail_file("create directory", directory, error.value());
  if (!fs::is_directory(directory, error))
    fail_file("create directory", directory, ENOTDIR);
}

}  // namespace physinv
