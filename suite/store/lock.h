/// One writer at a time in a directory.
#pragma once

#include <sys/file.h>

#include <string>

#include "suite/store/folder.h"

namespace physinv {

struct LockOptions {
  /// Where only a file can stand for the lock: take it from its owner.
  bool break_lock = false;
  /// Names of this host and boot; tests set others.
  std::string host = {}, boot = {};
  int (*flock)(int fd, int operation) = ::flock;
};

/// Held while a process writes to a directory, in its file `lock`. Dies with
/// its process; a forked child keeps it too.
///
/// On file systems without flock the file `lock.owner`, made exclusively,
/// stands for it: host, process and boot of its owner. What a process of this
/// machine left that is gone is taken over.
class DirectoryLock {
 public:
  DirectoryLock() = default;
  /// Throws StoreError if another process holds it.
  explicit DirectoryLock(const Folder& folder, const LockOptions& options = {});
  DirectoryLock(DirectoryLock&& o) noexcept { *this = std::move(o); }
  DirectoryLock& operator=(DirectoryLock&& o) noexcept;
  ~DirectoryLock();

  /// A warning for the user: no flock there, or whose lock was broken.
  const std::string& warning() const { return warning_; }

 private:
  void own(const Folder& folder, const LockOptions& options, int error);

  FileDescriptor fd_;
  std::string warning_;
  // Where a file stands for the lock: what it says, and its owner.
  std::filesystem::path directory_;
  std::string owner_;
  int process_ = 0;
};

}  // namespace physinv
