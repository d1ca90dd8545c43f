#include "suite/results/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <new>

namespace physinv {
namespace {

namespace fs = std::filesystem;

std::string_view advice(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
      return "make space or choose another --out; finished stages are kept";
    case EFBIG:
      return "raise the limit on file sizes (ulimit -f); finished stages are "
             "kept";
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

FileDescriptor open_file(const fs::path& path,
                         int flags,
                         std::string_view what) {
  FileDescriptor fd(
      retry([&] { return ::open(path.c_str(), flags | O_CLOEXEC, 0644); }));
  if (fd.get() < 0) fail_file(what, path, errno);
  return fd;
}

void write_aside(const fs::path& aside,
                 std::string_view bytes,
                 const fs::path& path) {
  const auto fd = open_file(aside, O_WRONLY | O_CREAT | O_TRUNC, "write");
  write_all(fd, bytes, path);
  sync(fd, path);
}

}  // namespace

void fail_file(std::string_view what, const fs::path& path, int error_number) {
  throw StoreError(fmt::format("cannot {} {}: {} ({})",
                               what,
                               path.string(),
                               std::strerror(error_number),
                               advice(error_number)));
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

void sync_directory(const fs::path& directory) {
  const auto fd = open_file(directory, O_RDONLY | O_DIRECTORY, "open");
  // Some network file systems cannot sync directories and say EINVAL.
  if (retry([&] { return ::fsync(fd.get()); }) < 0 && errno != EINVAL)
    fail_file("write", directory, errno);
}

void write_atomically(const fs::path& path, std::string_view bytes) {
  fs::path aside = path;
  aside += ".tmp";
  try {
    write_aside(aside, bytes, path);
    if (::rename(aside.c_str(), path.c_str()) < 0)
      fail_file("write", path, errno);
  } catch (...) {
    ::unlink(aside.c_str());
    throw;
  }
  sync_directory(path.parent_path().empty() ? "." : path.parent_path());
}

std::string read_file(const fs::path& path) {
  const auto fd = open_file(path, O_RDONLY, "read");
  struct stat info {};
  if (::fstat(fd.get(), &info) < 0) fail_file("read", path, errno);
  if (S_ISDIR(info.st_mode)) fail_file("read", path, EISDIR);
  std::string bytes(static_cast<std::size_t>(info.st_size), '\0');
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

std::string gzipped(std::string_view bytes) {
  constexpr int kGzip = 15 + 16;  // largest window, gzip's header
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

void make_directory(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) fail_file("create directory", directory, error.value());
  if (!fs::is_directory(directory, error))
    fail_file("create directory", directory, ENOTDIR);
}

DirectoryLock::DirectoryLock(const fs::path& directory) {
  const fs::path path = directory / "lock";
  fd_ = open_file(path, O_RDWR | O_CREAT, "lock");
  if (::flock(fd_.get(), LOCK_EX | LOCK_NB) < 0) {
    if (errno != EWOULDBLOCK) fail_file("lock", path, errno);
    throw StoreError(fmt::format(
        "cannot write to {}: process {} is running a campaign there (wait for "
        "it, end it, or choose another --out)",
        directory.string(),
        read_file(path)));
  }
  const std::string pid = std::to_string(::getpid());
  if (::ftruncate(fd_.get(), 0) < 0) fail_file("lock", path, errno);
  write_all(fd_, pid, path);
}

}  // namespace physinv
