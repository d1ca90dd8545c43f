#include "suite/store/store.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "suite/results/results.h"
#include "suite/store/missing_work.h"
#include "suite/store/results_file.h"
#include "suite/store/results_json.h"
#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

TEST(StageState, ComesBackOrIsNamedAsDamaged) {
  TemporaryDirectory out;
  const std::string key = hex128("a stage");
  EXPECT_FALSE(read_state(out / "nowhere", key));
  EXPECT_FALSE(read_state(out.path(), key));
  const StageState state{
      "a/case", "fit", 12, std::string("\0b\ny\0te", 7), {{0, 1}, {5, 3}}};
  write_state(out.path(), key, state);
  const auto back = read_state(out.path(), key);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->case_name, state.case_name);
  EXPECT_EQ(back->stage, state.stage);
  EXPECT_EQ(back->iteration, state.iteration);
  EXPECT_EQ(back->bytes, state.bytes);
  EXPECT_EQ(back->threads, state.threads);

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

/// A text of a megabyte is more than an attribute of HDF5 holds.
TEST_F(StoreTest, KeepsTextsOfAnyLength) {
  auto stage = sample_stage(a_, 0);
  stage.message = std::string(1000000, 'm') + "\n\xc3\xa9";
  a_.about.unknowns.names = std::string(1000000, 'n');
  a_.about.paper = std::string(1000000, 'p');
  {
    Store store(out_.path());
    store.set_plan({a_}, {{"date", "today"}, {"host_name", "here"}});
    store.append(a_, sample_data(a_), stage);
    store.finish();
  }
  const Results results = load_results(out_.path());
  ASSERT_EQ(results.cases().size(), 1U);
  const CaseRecord& own = results.cases().front();
  EXPECT_EQ(own.stages.front().message, stage.message);
  EXPECT_EQ(own.info.about.unknowns.names, a_.about.unknowns.names);
  EXPECT_EQ(own.info.about.paper, a_.about.paper);
  expect_same(stage, own.stages.front());
}

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

/// Stages that wait for a commit and those that are committed one by one.
class StoreOfBothWays : public StoreTest,
                        public testing::WithParamInterface<bool> {
 protected:
  void put(Store& store, const StageRecord& stage) {
    store.add(a_, sample_data(a_), stage);
    if (GetParam()) store.commit();
  }
};
INSTANTIATE_TEST_SUITE_P(Ways, StoreOfBothWays, testing::Bool());

TEST_P(StoreOfBothWays, OfOneStageTheFirstResultCounts) {
  Store store(out_.path());
  for (const std::uint64_t run : {1U, 2U}) put(store, sample_stage(a_, 0, run));
  store.finish();
  EXPECT_EQ(store.catalog().entries().size(), 1U);
  expect_same(*store.find(a_.keys[0]), sample_stage(a_, 0, 1));
}

TEST_P(StoreOfBothWays, AResultReplacesAFailure) {
  Store store(out_.path());
  auto failed = sample_stage(a_, 0);
  failed.stop = Stop::failed;
  put(store, failed);
  EXPECT_EQ(store.find(a_.keys[0])->stop, Stop::failed);
  put(store, sample_stage(a_, 0));
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
    EXPECT_TRUE(contains(message, "no results")) << message;
  }
}

TEST_F(StoreTest, WhatAKilledWriterBeganIsIncomplete) {
  Folder(out_.path()).write("lock", "");
  Folder(out_.path()).make("cases");
  const Catalog begun = Catalog::read(out_.path());
  EXPECT_TRUE(begun.entries().empty());
  EXPECT_TRUE(missing_work(begun, begun.cases()).any());
  Folder(out_.path()).write("results.json", "{}");
  EXPECT_THROW(Catalog::read(out_.path()), UnreadableInput)
      << "the journal of more is lost";
}

TEST_F(StoreTest, ResultsFromBeforeThePlanAreNotAltered) {
  const nlohmann::json today = {{"date", "today"}};
  {
    Store store(out_.path());
    store.set_plan({a_}, {{"date", "yesterday"}});
    for (Index k = 0; k < 2; ++k) append(store, a_, k);
    store.finish();
  }
  const auto checked = [&] { checked_cases(Catalog::read(out_.path())); };
  Store(out_.path()).set_plan({a_}, today);  // and is killed
  EXPECT_NO_THROW(checked());
  Store(out_.path()).set_plan({a_}, {{"date", "tomorrow"}});
  EXPECT_NO_THROW(checked());
  auto results = read_results(out_.path());
  results["context"]["date"] = "never";
  Folder(out_.path()).write("results.json", results_text(sealed(results)));
  EXPECT_TRUE(contains(message_of<StoreError>(checked), "about the context"));
  results["context"]["date"] = "yesterday";
  Folder(out_.path()).write("results.json", results_text(sealed(results)));
  EXPECT_NO_THROW(checked());
  Store store(out_.path());
  store.set_plan({a_}, today);
  store.finish();
  EXPECT_NO_THROW(checked());
  EXPECT_EQ(read_results(out_.path())["context"]["date"], "today");
}

TEST_F(StoreTest, ResultsFromBeforeTheStatusFtolAreRead) {
  const auto earlier = [&](const CaseInfo& info) {
    const TemporaryDirectory out;
    Store store(out.path());
    store.set_plan({info}, {{"date", "today"}});
    append(store, info, 0);
    store.finish();
    auto results = read_results(out.path());
    results["benchmarks"][0]["physinv"]["statuses"].erase("ftol");
    Folder(out.path()).write("results.json", results_text(sealed(results)));
    checked_cases(Catalog::read(out.path()));
  };
  EXPECT_NO_THROW(earlier(a_));
  const CaseInfo more = sample_case("bfgs", 8, 0);  // one of them is ftol
  EXPECT_TRUE(contains(message_of<StoreError>([&] { earlier(more); }),
                       "repetitions about jpo/sample"));
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

}  // namespace
}  // namespace physinv
