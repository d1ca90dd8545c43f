#include "suite/store/folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <memory>

#include "suite/core/hash.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kAside = ".physinv-", kEnd = ".tmp";
constexpr std::size_t kDigits = 16;
constexpr int kLook = O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY;
constexpr int kDirectory = O_RDONLY | O_DIRECTORY | O_CLOEXEC;

/// It cannot be predicted.
std::string new_name(std::string_view end) {
  std::uint64_t bits = 0;
  if (::getrandom(&bits, sizeof(bits), 0) != sizeof(bits))
    throw StoreError("the system has no random numbers (try again)");
  return fmt::format("{}{}{}", kAside, hex64(bits), end);
}

/// One component, so that it cannot lead elsewhere.
const char* component(const std::string& name) {
  if (name.empty() || name == "." || name == ".." ||
      name.find('/') != std::string::npos ||
      name.find('\0') != std::string::npos)
    throw StoreError(fmt::format("'{}' is not a file name in a store", name));
  return name.c_str();
}

/// What has the name itself, not what a link points at; 0 if nothing has.
mode_t mode_at(int directory, const std::string& name) {
  struct stat info {};
  return ::fstatat(directory, component(name), &info, AT_SYMLINK_NOFOLLOW) == 0
             ? info.st_mode
             : 0;
}

template <class Close, class T>
auto owned(T* p, Close close) {
  return std::unique_ptr<T, Close>(p, close);
}

}  // namespace

bool is_new_folder(std::string_view name) {
  return name.size() == kAside.size() + kDigits && name.starts_with(kAside) &&
         name.find_first_not_of("0123456789abcdef", kAside.size()) ==
             std::string_view::npos;
}

bool is_aside_file(std::string_view name) {
  return name.ends_with(kEnd) &&
         is_new_folder(name.substr(0, name.size() - kEnd.size()));
}

Folder::Folder(const fs::path& directory)
    : fd_(::open(directory.c_str(), kDirectory)), path_(directory) {
  if (fd_.get() < 0) fail_file("open", directory, errno);
}

std::optional<Folder> Folder::find(const std::string& name) const {
  Folder found;
  found.path_ = path_ / name;
  found.fd_ = FileDescriptor(
      ::openat(fd_.get(), component(name), kDirectory | O_NOFOLLOW));
  if (found.fd_.get() >= 0) return found;
  const int error = errno;
  if (error == ENOENT) return std::nullopt;
  if (const mode_t mode = mode_at(fd_.get(), name); mode != 0 && !S_ISDIR(mode))
    fail_kind("open", found.path_, mode, "a directory");
  fail_file("open", found.path_, error);
}

Folder Folder::make(const std::string& name) const {
  if (auto there = find(name)) return std::move(*there);
  if (::mkdirat(fd_.get(), name.c_str(), 0777) < 0 && errno != EEXIST)
    fail_file("create directory", path_ / name, errno);
  auto made = find(name);
  if (!made) fail_file("create directory", path_ / name, ENOENT);
  return std::move(*made);
}

Folder Folder::make_new() const {
  for (;;) {
    const std::string name = new_name("");
    if (::mkdirat(fd_.get(), name.c_str(), 0777) == 0) return make(name);
    if (errno != EEXIST) fail_file("create directory", path_ / name, errno);
  }
}

bool Folder::has(const std::string& name) const {
  return mode_at(fd_.get(), name) != 0;
}

std::vector<std::string> Folder::names() const {
  const int fd = ::openat(fd_.get(), ".", kDirectory);
  const auto all = owned(fd < 0 ? nullptr : ::fdopendir(fd), &::closedir);
  if (!all) fail_file("read", path_, errno);
  std::vector<std::string> names;
  while (const dirent* entry = ::readdir(all.get()))
    names.emplace_back(entry->d_name);
  return names;
}

FileDescriptor Folder::open(const std::string& name,
                            int flags,
                            std::string_view what) const {
  FileDescriptor fd(::openat(fd_.get(), component(name), flags | kLook, 0644));
  const int error = errno;
  struct stat info {};
  if (fd.get() < 0) info.st_mode = mode_at(fd_.get(), name);
  if (fd.get() >= 0 && ::fstat(fd.get(), &info) < 0)
    fail_file(what, path_ / name, errno);
  if (info.st_mode != 0 && !S_ISREG(info.st_mode))
    fail_kind(what, path_ / name, info.st_mode);
  if (fd.get() < 0) fail_file(what, path_ / name, error);
  return fd;
}

std::string Folder::read(const std::string& name, std::uint64_t limit) const {
  return read_all(open(name, O_RDONLY, "read"), path_ / name, limit);
}

std::pair<std::string, FileDescriptor> Folder::write_aside(
    const std::string& name, std::string_view bytes) const {
  const fs::path path = path_ / name;
  if (const mode_t mode = mode_at(fd_.get(), name); mode != 0 && !S_ISREG(mode))
    fail_kind("write", path, mode);
  std::string aside = new_name(kEnd);
  FileDescriptor fd(::openat(
      fd_.get(), aside.c_str(), O_WRONLY | O_CREAT | O_EXCL | kLook, 0644));
  if (fd.get() < 0) fail_file("write", path, errno);
  try {
    write_all(fd, bytes, path);
  } catch (...) {
    drop(aside);
    throw;
  }
  return {std::move(aside), std::move(fd)};
}

void Folder::drop(const std::string& aside) const noexcept {
  ::unlinkat(fd_.get(), aside.c_str(), 0);
}

void Folder::put_in_place(const std::string& aside,
                          const std::string& name) const {
  if (::renameat(fd_.get(), aside.c_str(), fd_.get(), name.c_str()) < 0)
    fail_file("write", path_ / name, errno);
}

void Folder::sync_names() const {
  // Some network file systems cannot sync directories and say EINVAL.
  while (::fsync(fd_.get()) < 0) {
    if (errno == EINVAL) break;
    if (errno != EINTR) fail_file("write", path_, errno);
  }
}

void Folder::write(const std::string& name, std::string_view bytes) const {
  const auto [aside, fd] = write_aside(name, bytes);
  try {
    sync(fd, path_ / name);
    put_in_place(aside, name);
  } catch (...) {
    drop(aside);
    throw;
  }
  sync_names();
}

FileGroup::~FileGroup() {
  for (const auto& [aside, name] : files_) folder_.drop(aside);
}

void FileGroup::add(const std::string& name, std::string_view bytes) {
  files_.emplace_back(folder_.write_aside(name, bytes).first, name);
}

void FileGroup::sync_contents() const {
  // A file system at once takes as long as one of its files.
  if (files_.size() > 1 && ::syncfs(folder_.fd_.get()) == 0) return;
  for (const auto& [aside, name] : files_)
    sync(folder_.open(aside, O_WRONLY, "write"), folder_.path() / name);
}

void FileGroup::put_in_place() {
  if (files_.empty()) return;
  sync_contents();
  while (!files_.empty()) {
    folder_.put_in_place(files_.back().first, files_.back().second);
    files_.pop_back();
  }
  folder_.sync_names();
}

bool Folder::create(const std::string& name, std::string_view bytes) const {
  const FileDescriptor fd(::openat(
      fd_.get(), component(name), O_WRONLY | O_CREAT | O_EXCL | kLook, 0644));
  if (fd.get() < 0 && errno == EEXIST) return false;
  if (fd.get() < 0) fail_file("write", path_ / name, errno);
  write_all(fd, bytes, path_ / name);
  return true;
}

bool Folder::remove_if(const std::string& name, std::string_view bytes) const {
  const std::string aside = new_name(kEnd);
  const mode_t mode = mode_at(fd_.get(), name);
  if (mode == 0) return false;
  if (!S_ISREG(mode)) fail_kind("delete", path_ / name, mode);
  if (::renameat(fd_.get(), component(name), fd_.get(), aside.c_str()) < 0)
    fail_file("delete", path_ / name, errno);
  const bool same = read(aside, kLargestText) == bytes;
  // Another process has put its own there meanwhile: it is restored.
  if (!same) ::linkat(fd_.get(), aside.c_str(), fd_.get(), name.c_str(), 0);
  remove(aside);
  return same;
}

void Folder::remove(const std::string& name) const {
  const mode_t mode = mode_at(fd_.get(), name);
  if (mode == 0) return;
  if (!S_ISREG(mode)) fail_kind("delete", path_ / name, mode);
  if (::unlinkat(fd_.get(), name.c_str(), 0) < 0 && errno != ENOENT)
    fail_file("delete", path_ / name, errno);
}

void Folder::remove_empty(const std::string& name) const {
  if (::unlinkat(fd_.get(), component(name), AT_REMOVEDIR) < 0 &&
      errno != ENOENT && errno != ENOTEMPTY && errno != EEXIST)
    fail_file("delete", path_ / name, errno);
}

void Folder::remove_leftovers() const {
  for (const auto& name : names())
    if (is_aside_file(name) && S_ISREG(mode_at(fd_.get(), name))) remove(name);
}

}  // namespace physinv
