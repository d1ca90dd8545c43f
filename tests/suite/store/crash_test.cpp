// Full disks and processes killed while they write.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <map>
#include <set>
#include <thread>

#include "suite/results/results.h"
#include "suite/store/store.h"
#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

constexpr int kSkip = 77;

/// A disk that becomes full and gets room again.
struct Disk {
  std::function<void()> fill, make_room;
  std::vector<std::string> words;  ///< of the error
  Index numbers;                   ///< of a stage
};

/// Appends until the disk is full, then checks that the store says so, is whole
/// and continues once there is room. 0 if so.
int fill_the_disk(const fs::path& out, const Disk& disk) {
  std::string message;
  std::size_t kept = 0;
  const auto append = [&](Store& store) {
    const auto info = sample_case("jpo", 4, kept);
    store.append(
        info, sample_data(info), sample_stage(info, 0, 0, disk.numbers));
  };
  {
    Store store(out);
    while (kept < 100 && message.empty()) {
      if (kept == 2) disk.fill();
      try {
        append(store), ++kept;
      } catch (const StoreError& e) {
        message = e.what();
      }
    }
  }
  if (message.empty() || kept < 2) return 1;
  for (const auto& word : disk.words)
    if (!contains(message, word)) return 2;
  if (load_results(out).cases().size() != kept) return 3;
  disk.make_room();
  Store store(out);
  append(store);
  store.finish();
  return store.cases().size() == kept + 1 ? 0 : 4;
}

template <class F>
int exit_code_of_child(F&& body) {
  const pid_t child = fork();
  if (child == 0) {
    int code = 99;
    try {
      code = body();
    } catch (const std::exception& e) {
      fmt::print(stderr, "{}\n", e.what());
    }
    _exit(code);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 100;
}

TEST(Crash, FullDiskIsSaidAndCostsNothing) {
  TemporaryDirectory out;
  const char* path = out.path().c_str();
  const int code = exit_code_of_child([&] {
    if (unshare(CLONE_NEWNS) != 0 ||
        mount("", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        mount("tmpfs", path, "tmpfs", 0, "size=256k") != 0)
      return kSkip;
    return fill_the_disk(
        out.path(),
        {.fill = [] {},
         .make_room = [&] { mount("", path, nullptr, MS_REMOUNT, "size=4m"); },
         .words = {"No space left on device", "free some space"},
         .numbers = 3000});
  });
  if (code == kSkip)
    GTEST_SKIP() << "mounting a small file system is not allowed here";
  EXPECT_EQ(code, 0);
}

TEST(Crash, FileSizeLimitIsSaidAndCostsNothing) {
  TemporaryDirectory out;
  const auto limit = [](rlim_t bytes) {
    const rlimit value{.rlim_cur = bytes, .rlim_max = RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &value);
  };
  EXPECT_EQ(exit_code_of_child([&] {
              std::signal(SIGXFSZ, SIG_IGN);
              return fill_the_disk(
                  out.path(),
                  {.fill = [&] { limit(20000); },
                   .make_room = [&] { limit(RLIM_INFINITY); },
                   .words = {"cannot write ", "finished stages are saved"},
                   .numbers = 5000});
            }),
            0);
}

/// Stage number i of a campaign of two-stage cases.
std::pair<CaseInfo, Index> stage_number(std::uint64_t i) {
  return {sample_case("jpo", 4, i / 2), static_cast<Index>(i % 2)};
}

/// Stages that go to the disk together.
constexpr std::uint64_t kTogether = 5;

/// Adds stage after stage, telling the last number once it is durable.
[[noreturn]] void write_until_killed(const fs::path& out,
                                     std::uint64_t from,
                                     std::uint64_t together,
                                     int told) {
  try {
    Store store(out);
    for (std::uint64_t i = from;; ++i) {
      const auto [info, position] = stage_number(i);
      store.add(info, sample_data(info), sample_stage(info, position));
      if ((i + 1 - from) % together != 0) continue;
      store.commit();
      if (write(told, &i, sizeof(i)) != sizeof(i)) _exit(1);
    }
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
  }
  _exit(2);
}

TEST(Crash, KilledAtAnyMomentNothingIsLostOrDoubled) {
  TemporaryDirectory out;
  std::uint64_t next = 0;  // the first stage that may be missing
  for (std::uint64_t round = 0; round < 100; ++round) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    const std::uint64_t together = round % 4 < 2 ? 1 : kTogether;
    if (child == 0) write_until_killed(out.path(), next, together, ends[1]);
    close(ends[1]);
    std::uint64_t durable = 0;
    // Every other writer is given time to finish a stage, on any machine.
    if (round % 2 == 1 &&
        read(ends[0], &durable, sizeof(durable)) == sizeof(durable))
      next = durable + 1;
    const auto wait = 30000 * sample_number(round);
    std::this_thread::sleep_for(
        std::chrono::microseconds(static_cast<int>(wait)));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the writer gave up";
    while (read(ends[0], &durable, sizeof(durable)) == sizeof(durable))
      next = durable + 1;
    close(ends[0]);

    if (!Store::exists(out.path())) continue;  // killed before the first line
    const auto store = Store::read_only(out.path());
    std::set<std::pair<std::string, Index>> seen;
    for (const auto& e : store.catalog().entries())
      ASSERT_TRUE(seen.insert({e.info.name, e.stage.position}).second);
    // One more commit may be there, or some of its lines: killed before it
    // could tell.
    ASSERT_GE(seen.size(), next);
    ASSERT_LE(seen.size(), next + together);
    next = seen.size();
    for (std::uint64_t i = next > 9 ? next - 9 : 0; i < next; ++i) {
      const auto [info, position] = stage_number(i);
      const auto found =
          store.find(info.keys[static_cast<std::size_t>(position)]);
      ASSERT_TRUE(found) << "round " << round << " stage " << i;
      expect_same(*found, sample_stage(info, position));
    }
  }
  std::size_t stages = 0;
  const auto results = load_results(out.path());
  for (const auto& c : results.cases()) stages += c.stages.size();
  EXPECT_EQ(stages, next);
  EXPECT_GT(next, 20U);
}

}  // namespace
}  // namespace physinv
