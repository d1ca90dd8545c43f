#include "suite/results/store.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <csignal>
#include <functional>
#include <nlohmann/json.hpp>

#include "suite/results/results.h"
#include "tests/suite/results/results_testing.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

void put(CaseFile& file, const StageRecord& record) {
  file.put_stage(record, hex64(arrays_hash(record)));
}

TEST(CaseFile, KeepsEveryBit) {
  TemporaryDirectory out;
  const auto info = sample_case("jpo", 8, 3);
  const auto data = sample_data(info);
  CaseFile file(info.name);
  file.put_data(data);
  for (Index k = 0; k < 2; ++k) put(file, sample_stage(info, k));
  const Folder folder(out.path());
  file.save(folder);

  const CaseFile back(folder, info.name);
  EXPECT_EQ(back.data().hash, data.hash);
  EXPECT_TRUE(same_bits(back.data().x, data.x));
  EXPECT_TRUE(same_bits(back.data().y, data.y));
  EXPECT_TRUE(same_bits(back.data().given, data.given));
  for (Index k = 0; k < 2; ++k) {
    const auto record = sample_stage(info, k);
    auto scalars = record;
    scalars.x.resize(0, 0), scalars.arrays.clear(), scalars.status.clear();
    back.read_stage(scalars, hex64(arrays_hash(record)));
    expect_same(record, scalars);
  }
}

About sample_about() {
  return {.problem = "sample",
          .paper = "Ann Ames: Title. Venue, 2022. arXiv:2203.10131",
          .arxiv = "2203.10131",
          .unknowns = {"angle, height", "rad, m"},
          .observations = {"y_1, y_2, y_3"},
          .given = {}};
}

TEST(CaseFile, DescribesItself) {
  auto info = sample_case("jpo", 4, 3);
  info.about = sample_about();
  auto stage = sample_stage(info, 1);
  CaseFile file(info.name);
  file.describe(info, sample_stage(info, 0));
  file.put_data(sample_data(info));
  stage.run.profile = "paper";
  file.describe(info, stage);  // the latest run counts
  put(file, stage);
  auto bytes = file.bytes();
  EXPECT_EQ(CaseFile(bytes, "path", info.name).about().paper, info.about.paper);
  EXPECT_EQ(CaseFile(bytes, "path", info.name).about().unknowns.unit, "rad, m");
  bytes.resize(bytes.size() - 16);
  const auto root = hdf5::open_image(bytes);
  EXPECT_EQ(hdf5::read_number(root, "schema"), kCaseVersion);
  EXPECT_EQ(hdf5::read_number(root, "n"), 4U);
  EXPECT_EQ(hdf5::read_number(root, "seed"), 3U);
  for (const auto& [name, text] : {std::pair("experiment", "jpo/sample"),
                                   {"problem", "sample"},
                                   {"method", "jpo"},
                                   {"precision", "f32"},
                                   {"profile", "paper"},
                                   {"revision", "abcdef+dirty"},
                                   {"arxiv", "2203.10131"},
                                   {"doi", "10.48550/arXiv.2203.10131"}})
    EXPECT_EQ(hdf5::read_attribute(root, name), text);
  const auto stages = hdf5::open_group(root, "stages");
  const auto group = hdf5::open_group(stages, "1_refine");
  EXPECT_EQ(hdf5::read_attribute(group, "stop"), "iterations");
  EXPECT_EQ(hdf5::note(group, "x").axes, "samples,unknowns");
  EXPECT_EQ(hdf5::note(group, "x").names, "angle, height");
  EXPECT_EQ(hdf5::rank(group, "loss"), 1);
  const auto curve = hdf5::open_group(group, "curve");
  EXPECT_EQ(hdf5::rank(curve, "x"), 3);
  EXPECT_EQ(hdf5::note(curve, "seconds").unit, "s");
}

/// As version 1 had it: one text, arrays of other shapes.
std::string file_of_version_1(const CaseInfo& info, const StageRecord& r) {
  const auto file = hdf5::new_file();
  hdf5::write_attribute(file, "case", info.name);
  const auto data = sample_data(info);
  const auto own = hdf5::create_group(file, "data");
  hdf5::write_attribute(own, "hash", data.hash);
  hdf5::write(own, "x", data.x);
  hdf5::write(own, "y", data.y);
  hdf5::write(own, "given", data.given);
  const auto stages = hdf5::create_group(file, "stages");
  const auto group =
      hdf5::create_group(stages, fmt::format("{}_{}", r.position, r.stage));
  hdf5::write_attribute(group, "key", r.key);
  hdf5::write_attribute(group, "hash", hex64(arrays_hash(r)));
  hdf5::write(group, "x", r.x);
  hdf5::write(group, "loss", Batch<double>(r.loss));
  const hsize_t n = r.status.size();
  const hdf5::Handle shape(
      H5Screate_simple(1, &n, nullptr), H5Sclose, "make a shape");
  const hdf5::Handle options(
      H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make a list");
  H5Pset_obj_track_times(options, false);
  const hdf5::Handle set(H5Dcreate2(group,
                                    "status",
                                    H5T_STD_U8LE,
                                    shape,
                                    H5P_DEFAULT,
                                    options,
                                    H5P_DEFAULT),
                         H5Dclose,
                         "create an array");
  H5Dwrite(
      set, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, r.status.data());
  hdf5::write(group, "iterations", Batch<double>(r.example_iterations));
  hdf5::write(group, "evaluations", Batch<double>(r.example_evaluations));
  const auto curve = hdf5::create_group(group, "curve");
  hdf5::write(curve, "iteration", r.curve.iteration);
  hdf5::write(curve, "seconds", r.curve.seconds);
  hdf5::write(curve, "evaluations", r.curve.evaluations);
  hdf5::write(curve, "loss", r.curve.loss);
  hdf5::write(curve, "x", r.curve.x);
  const auto arrays = hdf5::create_group(group, "arrays");
  for (const auto& [name, array] : r.arrays) hdf5::write(arrays, name, array);
  const auto bytes = hdf5::image(file);
  return fmt::format("{}physinv:{:08x}", bytes, crc32c(bytes));
}

TEST(CaseFile, OfVersion1IsReadAndWrittenAnew) {
  const auto info = sample_case("jpo", 4, 3);
  const auto first = sample_stage(info, 0), second = sample_stage(info, 1);
  CaseFile file(file_of_version_1(info, first), "path", info.name);
  const auto expect_stage = [&](const StageRecord& stage) {
    auto back = stage;
    back.x.resize(0, 0), back.arrays.clear(), back.status.clear();
    file.read_stage(back, hex64(arrays_hash(stage)));
    expect_same(stage, back);
  };
  expect_stage(first);
  EXPECT_EQ(file.data().hash, sample_data(info).hash);
  file.describe(info, second);
  file.put_data(sample_data(info));
  put(file, second);
  expect_stage(first);
  expect_stage(second);
  EXPECT_TRUE(file.has_stage(first, hex64(arrays_hash(first))));
  auto bytes = file.bytes();
  bytes.resize(bytes.size() - 16);
  const auto root = hdf5::open_image(bytes);
  EXPECT_EQ(hdf5::read_number(root, "schema"), kCaseVersion);
  const auto stages = hdf5::open_group(root, "stages");
  for (const char* name : {"0_fit", "1_refine"})
    EXPECT_EQ(hdf5::rank(hdf5::open_group(stages, name), "loss"), 1);
}

TEST(CaseFile, OfANewerVersionIsRefused) {
  const auto file = hdf5::new_file();
  hdf5::write_attribute(file, "case", "a/case");
  hdf5::write_attribute(file, "schema", kCaseVersion + 1);
  const auto bytes = hdf5::image(file);
  EXPECT_EQ(message_of<UnreadableInput>([&] {
              CaseFile(fmt::format("{}physinv:{:08x}", bytes, crc32c(bytes)),
                       "path",
                       "a/case");
            }),
            fmt::format("path: it is of version {}, this program reads up to "
                        "{} (use the program that wrote it or a newer one)",
                        kCaseVersion + 1,
                        kCaseVersion));
}

TEST(StageState, ComesBackOrIsNamedAsDamaged) {
  TemporaryDirectory out;
  const std::string key = hex128("a stage");
  EXPECT_FALSE(read_state(out / "nowhere", key));
  EXPECT_FALSE(read_state(out.path(), key));
  const StageState state{"a/case", "fit", 12, std::string("\0b\ny\0te", 7)};
  write_state(out.path(), key, state);
  const auto back = read_state(out.path(), key);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->case_name, state.case_name);
  EXPECT_EQ(back->stage, state.stage);
  EXPECT_EQ(back->iteration, state.iteration);
  EXPECT_EQ(back->bytes, state.bytes);

  const fs::path path = out / "checkpoints" / key;
  const auto bytes = read_file(path);
  const auto is_damaged = [&](const std::string& wrong) {
    return contains(message_of<StoreError>([&] { parse_state(wrong, path); }),
                    key + " is damaged");
  };
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto wrong = bytes;
    wrong[i] = static_cast<char>(wrong[i] ^ (1 << (i % 8)));
    ASSERT_TRUE(is_damaged(wrong)) << i;
    ASSERT_TRUE(is_damaged(bytes.substr(0, i))) << i;
  }
  remove_state(out.path(), key);
  EXPECT_FALSE(read_state(out.path(), key));
}

TEST(CaseFile, EveryFlippedBitIsFound) {
  TemporaryDirectory out;
  const auto info = sample_case("jpo", 2, 3);
  CaseFile file(info.name);
  file.put_data(sample_data(info));
  put(file, sample_stage(info, 0));
  const fs::path path = out / case_file_name(info.name);
  file.save(Folder(out.path()));
  const auto bytes = read_file(path);
  for (std::size_t i = 0; i < bytes.size(); i += 1 + bytes.size() / 199) {
    auto wrong = bytes;
    wrong[i] = static_cast<char>(wrong[i] ^ (1 << (i % 8)));
    const auto message =
        message_of<StoreError>([&] { CaseFile(wrong, path, info.name); });
    ASSERT_TRUE(contains(message, path.string() + " is damaged")) << i;
    ASSERT_THROW(CaseFile(bytes.substr(0, i), path, info.name), StoreError)
        << i;
  }
}

class StoreTest : public testing::Test {
 protected:
  void append(Store& store,
              const CaseInfo& info,
              Index position,
              std::uint64_t run = 0) {
    store.append(info, sample_data(info), sample_stage(info, position, run));
  }

  TemporaryDirectory out_;
  CaseInfo a_ = sample_case("bfgs", 4, 0), b_ = sample_case("jpo", 4, 0);
};

TEST_F(StoreTest, FindsWhatWasAppendedAlsoLater) {
  {
    Store store(out_.path());
    for (Index k = 0; k < 2; ++k) append(store, a_, k), append(store, b_, k);
    expect_same(*store.find(b_.keys[1]), sample_stage(b_, 1));
    EXPECT_FALSE(store.find("nothing"));
  }
  Store store(out_.path());
  for (Index k = 0; k < 2; ++k)
    expect_same(*store.find(a_.keys[static_cast<std::size_t>(k)]),
                sample_stage(a_, k));
}

TEST_F(StoreTest, WhatWasAddedIsFoundAtOnceAndThereAfterACommit) {
  Store store(out_.path());
  for (Index k = 0; k < 2; ++k)
    for (const auto& info : {a_, b_})
      store.add(info, sample_data(info), sample_stage(info, k));
  expect_same(*store.find(b_.keys[1]), sample_stage(b_, 1));
  const std::set<std::string> only_b = {b_.name};
  EXPECT_FALSE(store.find(a_.keys[0], &only_b));
  EXPECT_TRUE(Store::read_only(out_.path()).catalog().entries().empty());
  EXPECT_TRUE(store.is_due(0));
  EXPECT_FALSE(store.is_due(60));
  store.commit();
  EXPECT_FALSE(store.is_due(0));
  const auto read = Store::read_only(out_.path());
  EXPECT_EQ(read.catalog().entries().size(), 4U);
  for (const auto& info : {a_, b_})
    for (Index k = 0; k < 2; ++k)
      expect_same(*read.find(info.keys[static_cast<std::size_t>(k)]),
                  sample_stage(info, k));
}

TEST_F(StoreTest, OfOneStageAddedTwiceTheFirstCounts) {
  Store store(out_.path());
  for (const std::uint64_t run : {1U, 2U})
    store.add(a_, sample_data(a_), sample_stage(a_, 0, run));
  store.finish();
  EXPECT_EQ(store.catalog().entries().size(), 1U);
  expect_same(*store.find(a_.keys[0]), sample_stage(a_, 0, 1));
}

TEST_F(StoreTest, AResultAddedAfterAFailureReplacesIt) {
  Store store(out_.path());
  auto failed = sample_stage(a_, 0);
  failed.stop = Stop::failed;
  store.add(a_, sample_data(a_), failed);
  EXPECT_EQ(store.find(a_.keys[0])->stop, Stop::failed);
  store.add(a_, sample_data(a_), sample_stage(a_, 0));
  EXPECT_TRUE(has_result(*store.find(a_.keys[0])));
  store.commit();
  expect_same(*Store::read_only(out_.path()).find(a_.keys[0]),
              sample_stage(a_, 0));
}

/// Bytes that this process gave to write() so far.
std::uint64_t bytes_written() {
  std::ifstream io("/proc/self/io");
  std::string name;
  std::uint64_t count = 0;
  while (io >> name >> count && name != "wchar:") {
  }
  return count;
}

TEST_F(StoreTest, ACommitWritesTheFileOfACaseOnce) {
  a_.stages.clear(), a_.keys.clear();
  for (int k = 0; k < 20; ++k) {
    a_.stages.push_back(fmt::format("stage{}", k));
    a_.keys.push_back(hex128(a_.stages.back()));
  }
  Store store(out_.path());
  const auto before = bytes_written();
  for (Index k = 0; k < 20; ++k)
    store.add(a_, sample_data(a_), sample_stage(a_, k, 0, 2000));
  store.commit();
  const auto there = fs::file_size(store.catalog().case_path(a_.name)) +
                     fs::file_size(out_ / "journal.jsonl");
  EXPECT_LT(bytes_written() - before, there + there / 10);
}

TEST_F(StoreTest, StageIsKeptOnceAndTheFirstCounts) {
  Store store(out_.path());
  append(store, a_, 0, 1);
  append(store, a_, 0, 2);
  EXPECT_EQ(store.catalog().entries().size(), 1U);
  expect_same(*store.find(a_.keys[0]), sample_stage(a_, 0, 1));
}

TEST_F(StoreTest, ResultReplacesAFailure) {
  Store store(out_.path());
  auto failed = sample_stage(a_, 0);
  failed.stop = Stop::failed;
  store.append(a_, sample_data(a_), failed);
  EXPECT_EQ(store.find(a_.keys[0])->stop, Stop::failed);
  append(store, a_, 0);
  expect_same(*Store::read_only(out_.path()).find(a_.keys[0]),
              sample_stage(a_, 0));
}

TEST_F(StoreTest, ChangedKeyReplacesAndItsFollowersAreOutdated) {
  Store store(out_.path());
  append(store, a_, 0), append(store, a_, 1);
  const auto old = a_.keys;
  a_.keys = {hex128("new fit"), hex128("new refine")};
  EXPECT_FALSE(store.find(hex128("new fit")));
  append(store, a_, 0);
  EXPECT_FALSE(store.find(old[0]));
  const auto results = load_results(out_.path());
  ASSERT_EQ(results.cases().size(), 1U);
  ASSERT_EQ(results.cases()[0].stages.size(), 1U);
  EXPECT_EQ(results.cases()[0].stages[0].key, hex128("new fit"));
}

TEST_F(StoreTest, CasesShareStagesByKey) {
  Store store(out_.path());
  append(store, a_, 0);
  b_.keys[0] = a_.keys[0];
  auto record = *store.find(b_.keys[0]);
  EXPECT_EQ(record.case_name, a_.name);
  record.case_name = b_.name;
  store.append(b_, sample_data(b_), record);
  EXPECT_EQ(store.cases().size(), 2U);
}

TEST_F(StoreTest, MissingArraysMakeTheStageRunAgain) {
  Store store(out_.path());
  append(store, a_, 0), append(store, b_, 0);
  fs::remove(store.catalog().case_path(a_.name));
  EXPECT_FALSE(store.find(a_.keys[0]));
  EXPECT_TRUE(store.find(b_.keys[0]));
  append(store, a_, 0, 7);
  expect_same(*Store::read_only(out_.path()).find(a_.keys[0]),
              sample_stage(a_, 0, 7));
}

TEST_F(StoreTest, OnlyOneWriter) {
  const Store store(out_.path());
  const auto message =
      message_of<StoreError>([&] { Store second(out_.path()); });
  EXPECT_TRUE(contains(message, fmt::format("process {} ", getpid())));
  EXPECT_FALSE(contains(message, "\n"));
  EXPECT_NO_THROW(load_results(out_.path()));
}

TEST_F(StoreTest, ForgetsWhatIsNamedAndNothingElse) {
  write_file(out_ / "mine.txt", "kept");
  Store store(out_.path());
  append(store, a_, 0), append(store, b_, 0);
  store.finish();
  store.forget({a_.name});
  EXPECT_FALSE(store.find(a_.keys[0]));
  EXPECT_FALSE(fs::exists(store.catalog().case_path(a_.name)));
  EXPECT_TRUE(fs::exists(out_ / "mine.txt"));
  const auto results = read_file(out_ / "results.json");
  EXPECT_FALSE(contains(results, a_.name));
  EXPECT_TRUE(contains(results, b_.name));
  append(store, a_, 0, 7);
  const auto again = Store::read_only(out_.path());
  expect_same(*again.find(a_.keys[0]), sample_stage(a_, 0, 7));
  expect_same(*again.find(b_.keys[0]), sample_stage(b_, 0));
}

TEST_F(StoreTest, KilledWhileForgettingItGoesOn) {
  {
    Store store(out_.path());
    append(store, a_, 0), append(store, b_, 0);
  }
  forget_cases(out_ / "journal.jsonl", {a_.name});  // its file is still there
  Store store(out_.path());
  EXPECT_FALSE(store.find(a_.keys[0]));
  EXPECT_TRUE(store.find(b_.keys[0]));
  append(store, a_, 0, 7);
  expect_same(*Store::read_only(out_.path()).find(a_.keys[0]),
              sample_stage(a_, 0, 7));
}

TEST_F(StoreTest, FindsAmongTheCasesNamed) {
  Store store(out_.path());
  append(store, a_, 0);
  const std::set<std::string> only_b = {b_.name}, only_a = {a_.name};
  EXPECT_TRUE(store.find(a_.keys[0], &only_a));
  EXPECT_FALSE(store.find(a_.keys[0], &only_b));
}

TEST_F(StoreTest, NoResultsIsSaid) {
  for (const auto& directory : {out_.path(), out_ / "nowhere"}) {
    const auto message =
        message_of<UnreadableInput>([&] { load_results(directory); });
    EXPECT_TRUE(contains(message, "no results there")) << message;
  }
}

TEST_F(StoreTest, FileInsteadOfADirectory) {
  write_file(out_ / "file", "");
  EXPECT_THROW(Store(out_ / "file"), StoreError);
  EXPECT_THROW(Store(out_ / "file" / "below"), StoreError);
}

TEST_F(StoreTest, UnwritableDirectory) {
  const bool root = geteuid() == 0;
  fs::permissions(out_.path(),
                  fs::perms::owner_read | fs::perms::owner_exec |
                      fs::perms::others_read | fs::perms::others_exec);
  if (root && seteuid(65534) != 0) GTEST_SKIP() << "cannot give up root";
  const auto message = message_of<StoreError>([&] { Store s(out_.path()); });
  ASSERT_EQ(seteuid(root ? 0 : geteuid()), 0);
  fs::permissions(out_.path(), fs::perms::owner_all);
  EXPECT_TRUE(contains(message, "Permission denied")) << message;
  EXPECT_TRUE(contains(message, "--out")) << message;
}

/// In a child process: appends until the disk is full, then checks that the
/// store says so, is whole and goes on once there is room. 0 if so.
int fill_the_disk(const fs::path& out,
                  const std::function<void()>& make_full,
                  const std::function<void()>& make_room) {
  int kept = 0;
  std::string message;
  {
    Store store(out);
    for (std::uint64_t seed = 0; seed < 100 && message.empty(); ++seed) {
      const auto info = sample_case("jpo", 4, seed);
      if (seed == 2) make_full();
      try {
        store.append(info, sample_data(info), sample_stage(info, 0, 0, 5000));
        ++kept;
      } catch (const StoreError& e) {
        message = e.what();
      }
    }
  }
  if (message.empty() || kept < 2) return 1;
  if (!contains(message, "cannot write ") ||
      !contains(message, "finished stages are kept"))
    return 2;
  if (static_cast<int>(load_results(out).cases().size()) != kept) return 3;
  make_room();
  const auto info = sample_case("jpo", 4, static_cast<std::uint64_t>(kept));
  Store store(out);
  store.append(info, sample_data(info), sample_stage(info, 0, 0, 5000));
  store.finish();
  return static_cast<int>(store.cases().size()) == kept + 1 ? 0 : 4;
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

TEST_F(StoreTest, FileSizeLimit) {
  EXPECT_EQ(
      exit_code_of_child([&] {
        const auto limit = [](rlim_t bytes) {
          const rlimit value{.rlim_cur = bytes, .rlim_max = RLIM_INFINITY};
          setrlimit(RLIMIT_FSIZE, &value);
        };
        std::signal(SIGXFSZ, SIG_IGN);
        return fill_the_disk(
            out_.path(), [&] { limit(20000); }, [&] { limit(RLIM_INFINITY); });
      }),
      0);
}

}  // namespace
}  // namespace physinv
