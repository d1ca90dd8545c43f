#include "suite/store/lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <sstream>

namespace physinv {
namespace {

namespace fs = std::filesystem;

constexpr const char *kLock = "lock", *kOwner = "lock.owner";
constexpr std::uint64_t kLargestOwner = 4096;

std::string file_system(int fd) {
  struct statfs info {};
  if (::fstatfs(fd, &info) != 0) return "an unknown file system";
  switch (static_cast<std::uint32_t>(info.f_type)) {
    case 0x6969:
      return "NFS";
    case 0x0bd00bd0:
      return "Lustre";
    case 0x47504653:
      return "GPFS";
    case 0x19830326:
      return "BeeGFS";
    case 0x00c36400:
      return "Ceph";
    case 0xff534d42:
    case 0xfe534d42:
    case 0x517b:
      return "SMB";
    case 0x5346414f:
      return "AFS";
    case 0xaad7aaea:
      return "PanFS";
    case 0x01021997:
      return "9P";
    case 0x65735546:
      return "FUSE";
    case 0x794c7630:
      return "overlayfs";
    case 0x01021994:
      return "tmpfs";
    case 0xef53:
      return "ext4";
    case 0x58465342:
      return "XFS";
    case 0x9123683e:
      return "Btrfs";
    case 0x2fc12fc1:
      return "ZFS";
    default:
      return fmt::format("a file system of type {:#x}", info.f_type);
  }
}

std::string host_name() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.front() == '\0' ? "localhost" : name.data();
}

/// /proc's files have no size, so they are not read as other files are.
std::string boot_id() {
  const FileDescriptor fd(
      ::open("/proc/sys/kernel/random/boot_id", O_RDONLY | O_CLOEXEC));
  std::array<char, 64> text{};
  const auto n = ::read(fd.get(), text.data(), text.size() - 1);
  std::string id(text.data(), n > 0 ? static_cast<std::size_t>(n) : 0);
  return id.substr(0, id.find('\n'));
}

struct Owner {
  std::string host, boot;
  long process = 0;  ///< 0 if the file does not say

  std::string text() const {
    return fmt::format("{} {} {}\n", host, process, boot);
  }
  std::string name() const {
    return process == 0 ? "an unknown process"
                        : fmt::format("process {} on {}", process, host);
  }
};

bool printable(const std::string& text) {
  for (const char c : text)
    if (c <= ' ' || c > '~') return false;
  return !text.empty();
}

Owner owner_in(const std::string& text) {
  Owner owner;
  std::istringstream words(text);
  words >> owner.host >> owner.process >> owner.boot;
  return words && owner.process > 0 && printable(owner.host) ? owner : Owner();
}

Owner this_process(const LockOptions& options) {
  return {.host = options.host.empty() ? host_name() : options.host,
          .boot = options.boot.empty() ? boot_id() : options.boot,
          .process = ::getpid()};
}

/// Of this machine, and ended for certain.
bool is_gone(const Owner& owner, const Owner& self) {
  if (owner.process == 0 || owner.host != self.host) return false;
  return owner.boot != self.boot ||
         (::kill(static_cast<pid_t>(owner.process), 0) < 0 && errno == ESRCH);
}

[[noreturn]] void fail_held(const Folder& folder, const std::string& holder) {
  throw StoreError(fmt::format(
      "cannot write to {}: {} is running a campaign there (wait for it, end "
      "it, or choose another --out)",
      folder.path().string(),
      holder));
}

/// The process that the lock names; any process may have written there.
std::string holder(const Folder& folder) {
  const auto text = folder.read(kLock, kLargestOwner);
  const bool number = !text.empty() && text.size() < 20 &&
                      text.find_first_not_of("0123456789") == text.npos;
  return number ? "process " + text : "another process";
}

FileDescriptor open_lock(const Folder& folder) {
  auto fd = folder.open(kLock, O_RDWR | O_CREAT, "lock");
  struct stat info {};
  if (::fstat(fd.get(), &info) < 0)
    fail_file("lock", folder.path() / kLock, errno);
  if (info.st_nlink > 1)
    throw StoreError(fmt::format(
        "cannot lock {}: other hard links to this file exist (delete this one)",
        (folder.path() / kLock).string()));
  return fd;
}

bool has_no_locks(int error) {
  return error == ENOLCK || error == ENOSYS || error == EOPNOTSUPP ||
         error == EINVAL;
}

}  // namespace

DirectoryLock::DirectoryLock(const Folder& folder, const LockOptions& options) {
  const fs::path path = folder.path() / kLock;
  fd_ = open_lock(folder);
  if (options.flock(fd_.get(), LOCK_EX | LOCK_NB) < 0) {
    if (errno == EWOULDBLOCK) fail_held(folder, holder(folder));
    if (!has_no_locks(errno)) fail_file("lock", path, errno);
    own(folder, options, errno);
  }
  const std::string pid = std::to_string(::getpid());
  if (::ftruncate(fd_.get(), 0) < 0) fail_file("lock", path, errno);
  write_all(fd_, pid, path);
}

void DirectoryLock::own(const Folder& folder,
                        const LockOptions& options,
                        int error) {
  const Owner self = this_process(options);
  warning_ = fmt::format(
      "{} is on {}, which has no locks ({}): using the file {} as the lock",
      folder.path().string(),
      file_system(fd_.get()),
      std::strerror(error),
      kOwner);
  while (!folder.create(kOwner, self.text())) {
    const std::string text = folder.read(kOwner, kLargestOwner);
    const Owner owner = owner_in(text);
    const bool gone = is_gone(owner, self);
    if (!gone && !options.break_lock)
      throw StoreError(
          fmt::format("cannot write to {}: {} is running a campaign there, "
                      "according to {} (wait for it, give --break-lock if it "
                      "has ended, or choose another --out)",
                      folder.path().string(),
                      owner.name(),
                      kOwner));
    if (folder.remove_if(kOwner, text))
      warning_ += fmt::format(
          "; the lock of {} is {}",
          owner.name(),
          gone ? "replaced, because the process has ended" : "broken");
  }
  directory_ = folder.path();
  owner_ = self.text();
  process_ = ::getpid();
}

DirectoryLock& DirectoryLock::operator=(DirectoryLock&& o) noexcept {
  std::swap(fd_, o.fd_);
  std::swap(warning_, o.warning_);
  std::swap(directory_, o.directory_);
  std::swap(owner_, o.owner_);
  std::swap(process_, o.process_);
  return *this;
}

DirectoryLock::~DirectoryLock() {
  if (process_ == 0 || process_ != ::getpid()) return;
  try {
    Folder(directory_).remove_if(kOwner, owner_);
  } catch (const StoreError&) {  // the next process finds that we have ended
  }
}

}  // namespace physinv
