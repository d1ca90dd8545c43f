#include "suite/store/lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cerrno>

#include "suite/store/merge.h"
#include "suite/store/store.h"
#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

template <int kError>
int fails(int, int) {
  errno = kError;
  return -1;
}

/// A process that has ended.
long ended_process() {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return child;
}

class LockTest : public testing::Test {
 protected:
  LockOptions without() {
    return {.host = "here", .boot = "this", .flock = fails<ENOLCK>};
  }
  void left(const std::string& text) { write_file(out_ / "lock.owner", text); }
  std::string owner() { return read_file(out_ / "lock.owner"); }
  std::string refusal(const LockOptions& options) {
    return message_of<StoreError>(
        [&] { DirectoryLock lock(folder_, options); });
  }

  TemporaryDirectory out_;
  Folder folder_ = Folder(out_.path());
};

TEST_F(LockTest, FlockLeavesNoFileThatStandsForIt) {
  const DirectoryLock lock(folder_);
  EXPECT_EQ(lock.warning(), "");
  EXPECT_FALSE(folder_.has("lock.owner"));
}

TEST_F(LockTest, WithoutFlockAFileStandsForIt) {
  {
    const DirectoryLock lock(folder_, without());
    EXPECT_EQ(owner(), fmt::format("here {} this\n", getpid()));
    EXPECT_TRUE(contains(lock.warning(), "which has no locks"))
        << lock.warning();
    EXPECT_TRUE(contains(lock.warning(), "No locks available"));
    const auto message = refusal(without());
    EXPECT_TRUE(contains(message, fmt::format("process {} on here", getpid())))
        << message;
    EXPECT_FALSE(contains(message, "\n"));
  }
  EXPECT_FALSE(folder_.has("lock.owner"));
  for (const auto flock :
       {fails<ENOLCK>, fails<ENOSYS>, fails<EOPNOTSUPP>, fails<EINVAL>})
    EXPECT_NO_THROW(DirectoryLock(folder_, {.flock = flock}));
  EXPECT_THROW(DirectoryLock(folder_, {.flock = fails<EIO>}), StoreError);
}

TEST_F(LockTest, AForkedChildKeepsIt) {
  const DirectoryLock lock(folder_, without());
  const pid_t child = fork();
  if (child == 0) {
    {
      DirectoryLock copy;
      copy = std::move(const_cast<DirectoryLock&>(lock));
    }
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(folder_.has("lock.owner"));
}

TEST_F(LockTest, WhoHasEndedHereIsSucceeded) {
  for (const auto& text : {fmt::format("here {} this\n", ended_process()),
                           fmt::format("here {} earlier\n", getpid())}) {
    left(text);
    const DirectoryLock lock(folder_, without());
    EXPECT_TRUE(contains(lock.warning(), "is replaced")) << lock.warning();
    EXPECT_EQ(owner(), fmt::format("here {} this\n", getpid()));
  }
}

TEST_F(LockTest, AnotherMachinesIsBrokenOnlyIfAsked) {
  for (const std::string text : {"there 1 this\n",
                                 "",
                                 "here\n",
                                 "here 0 this",
                                 "here x this",
                                 "\n\n\n"}) {
    left(text);
    const auto message = refusal(without());
    EXPECT_TRUE(contains(message, "--break-lock")) << message;
    EXPECT_EQ(owner(), text);
    auto options = without();
    options.break_lock = true;
    const DirectoryLock lock(folder_, options);
    EXPECT_TRUE(contains(lock.warning(), "is broken")) << lock.warning();
    EXPECT_EQ(contains(lock.warning(), "process 1 on there"),
              text.starts_with("there"));
  }
}

TEST_F(LockTest, WhatAnotherHasMadeItsOwnIsNotRemoved) {
  const std::string other = "there 5 this\n";
  {
    const DirectoryLock lock(folder_, without());
    left(other);  // broken meanwhile
  }
  EXPECT_EQ(owner(), other);
}

TEST_F(LockTest, StoresAndMergesSayIt) {
  const auto info = sample_case("a", 4, 0);
  {
    Store store(out_ / "shard", without());
    EXPECT_TRUE(contains(store.warning(), "which has no locks"));
    store.set_plan({info}, nlohmann::json::object());
    EXPECT_THROW(Store(out_ / "shard", without()), StoreError);
  }
  const auto merged = merge({out_ / "shard"}, out_ / "merged", without());
  ASSERT_EQ(merged.warnings.size(), 1U);
  EXPECT_TRUE(contains(merged.warnings[0], "which has no locks"));
}

TEST_F(LockTest, FilesOfOthersAreNotWrittenInto) {
  write_file(out_ / "precious", "kept");
  fs::create_hard_link(out_ / "precious", out_ / "lock");
  EXPECT_TRUE(contains(refusal({}), "other hard links"));
  fs::remove(out_ / "lock");
  fs::create_symlink("precious", out_ / "lock");
  EXPECT_TRUE(contains(refusal({}), "it is a link"));
  EXPECT_EQ(read_file(out_ / "precious"), "kept");
  fs::remove(out_ / "lock");
  fs::create_symlink("precious", out_ / "lock.owner");
  EXPECT_TRUE(contains(refusal(without()), "it is a link"));
  EXPECT_EQ(read_file(out_ / "precious"), "kept");
}

}  // namespace
}  // namespace physinv
