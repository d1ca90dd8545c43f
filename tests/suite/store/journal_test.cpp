#include "suite/store/journal.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "suite/results/results.h"
#include "suite/store/checksum.h"
#include "suite/store/store.h"
#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

JournalEntry sample_entry(std::uint64_t seed) {
  const auto info = sample_case("jpo", 4, seed);
  return {.info = info,
          .stage = sample_stage(info, 0),
          .file = "cases/a.h5",
          .data_hash = "d",
          .arrays_hash = "a"};
}

class JournalTest : public testing::Test {
 protected:
  JournalTest() {
    auto journal = Journal::create(path_);
    for (std::uint64_t seed = 0; seed < 3; ++seed)
      journal.append(sample_entry(seed));
    bytes_ = read_file(path_);
    last_ = bytes_.rfind('\n', bytes_.size() - 2) + 1;
  }

  TemporaryDirectory out_;
  std::filesystem::path path_ = out_ / "journal.jsonl";
  std::string bytes_;
  std::size_t last_ = 0;  // where the last line begins
};

TEST_F(JournalTest, KeepsEntriesInOrder) {
  const auto text = read_journal(path_);
  ASSERT_EQ(text.entries.size(), 3U);
  EXPECT_EQ(text.warning, "");
  EXPECT_EQ(text.good_bytes, bytes_.size());
  EXPECT_EQ(text.entries[2].info.seed, 2U);
  EXPECT_EQ(text.entries[2].arrays_hash, "a");
}

TEST_F(JournalTest, TornLastLineIsNamedAndCutOffByTheWriterOnly) {
  for (std::size_t size = last_ + 1; size < bytes_.size(); ++size) {
    write_file(path_, bytes_.substr(0, size));
    const auto text = read_journal(path_);
    ASSERT_EQ(text.entries.size(), 2U) << size;
    ASSERT_TRUE(
        contains(text.warning, fmt::format("line 4, at byte {}", last_)));
    ASSERT_EQ(std::filesystem::file_size(path_), size);
  }
  auto journal = Journal::resume(path_, read_journal(path_));
  EXPECT_EQ(read_file(path_), bytes_.substr(0, last_));
  journal.append(sample_entry(2));
  EXPECT_EQ(read_file(path_), bytes_);
}

TEST_F(JournalTest, FlippedBitIsFoundAndNothingChanged) {
  for (std::size_t i = 0; i < bytes_.size(); ++i) {
    auto wrong = bytes_;
    wrong[i] = static_cast<char>(wrong[i] ^ (1 << (i % 8)));
    write_file(path_, wrong);
    if (i + 1 == bytes_.size()) {  // a torn line: its stage runs again
      const auto text = read_journal(path_);
      ASSERT_EQ(text.entries.size(), 2U) << i;
      ASSERT_NE(text.warning, "") << i;
    } else {
      const auto message =
          message_of<CorruptJournal>([&] { read_journal(path_); });
      ASSERT_TRUE(contains(message, path_.string())) << i;
      const auto begin = i == 0 ? 0 : bytes_.rfind('\n', i - 1) + 1;
      ASSERT_TRUE(contains(message, fmt::format("at byte {} ", begin)))
          << i << " " << message;
    }
    ASSERT_EQ(read_file(path_), wrong);
  }
}

TEST_F(JournalTest, DamagedLineStopsAWriterWithoutChangingAnything) {
  bytes_[last_ - 20] ^= 1;
  write_file(path_, bytes_);
  const auto message =
      message_of<CorruptJournal>([&] { Store store(out_.path()); });
  EXPECT_TRUE(contains(message, "line 3"));
  EXPECT_TRUE(contains(message, "delete this line, sed -i 3d"));
  EXPECT_EQ(read_file(path_), bytes_);
}

TEST_F(JournalTest, ForgetsTheLinesOfACaseAndNoOthers) {
  const auto second = bytes_.find('\n') + 1;
  const auto third = bytes_.find('\n', second) + 1;
  forget_cases(path_, {sample_entry(0).info.name, "unknown"});
  EXPECT_EQ(read_file(path_), bytes_.substr(0, second) + bytes_.substr(third));
}

TEST_F(JournalTest, LinesCanBeDeleted) {
  const auto second = bytes_.find('\n') + 1;
  const auto third = bytes_.find('\n', second) + 1;
  write_file(path_, bytes_.substr(0, second) + bytes_.substr(third));
  EXPECT_EQ(read_journal(path_).entries.size(), 2U);
}

TEST_F(JournalTest, NewerSchemaIsRefused) {
  const std::string header = R"({"schema_version":2})";
  write_file(path_, fmt::format("{:08x} {}\n", crc32c(header), header));
  for (const bool write : {false, true}) {
    const auto message = message_of<UnreadableInput>([&] {
      if (write) {
        Store store(out_.path());
      } else {
        load_results(out_.path());
      }
    });
    EXPECT_TRUE(contains(message, "schema version is 2"));
  }
}

TEST_F(JournalTest, EmptyFileIsAnError) {
  write_file(path_, "");
  EXPECT_THROW(read_journal(path_), CorruptJournal);
}

}  // namespace
}  // namespace physinv
