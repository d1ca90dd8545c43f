// Files with good checksums that the suite did not write: read as what they
// are or named as damaged, and never a way to files elsewhere.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "suite/results/exports.h"
#include "suite/results/published.h"
#include "suite/results/results.h"
#include "suite/store/merge.h"
#include "suite/store/names.h"
#include "suite/store/plan.h"
#include "suite/store/repetitions.h"
#include "suite/store/results_file.h"
#include "suite/store/results_json.h"
#include "suite/store/store.h"
#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Json = nlohmann::ordered_json;

std::string sealed(const json& content) {
  const auto text = content.dump();
  return fmt::format("{:08x} {}\n", crc32c(text), text);
}

/// Deeper than a stack is.
std::string deep() {
  return std::string(1000000, '[') + std::string(1000000, ']');
}

/// Only a StoreError, with the file's name and in one line; true if so.
template <class F>
bool is_named(F&& read, const std::string& name) {
  try {
    read();
    return false;
  } catch (const StoreError& e) {
    EXPECT_TRUE(contains(e.what(), name)) << e.what();
    EXPECT_FALSE(contains(e.what(), "\n")) << e.what();
    return true;
  }
}

class ForeignTest : public testing::Test {
 protected:
  ForeignTest() {
    Store store(out_ / "store");
    store.set_plan({info_},
                   {{"fingerprint", "f"}, {"options", {{"set", {"n=4"}}}}});
    for (Index k = 0; k < 2; ++k)
      store.append(info_, sample_data(info_), sample_stage(info_, k));
    store.finish();
    const auto text = read_file(journal_);
    header_ = text.substr(0, text.find('\n') + 1);
    const auto second = text.find('\n', header_.size());
    line_ = json::parse(
        text.substr(header_.size() + 9, second - header_.size() - 9));
    plan_ = json::parse(read_file(out_ / "store" / "plan.json"));
    write_file(out_ / "precious", "kept");
  }

  /// Puts this line first, as a shard would have it.
  void forge(const json& line) { write_file(journal_, header_ + sealed(line)); }
  std::string outside() { return read_file(out_ / "precious"); }

  TemporaryDirectory out_;
  fs::path journal_ = out_ / "store" / "journal.jsonl";
  CaseInfo info_ = sample_case("jpo", 4, 0);
  std::string header_;
  json line_, plan_;
};

TEST_F(ForeignTest, NamesAndKeysAreSuchAsTheSuiteMakes) {
  EXPECT_TRUE(is_case_name("jpo/billiards/jpo/n=64/rate=1e-05/seed=3"));
  EXPECT_TRUE(is_case_name("a.b+c/..d"));
  for (const std::string name : {"",
                                 "/a",
                                 "a/",
                                 "a//b",
                                 "..",
                                 "a/../b",
                                 "./a",
                                 "A",
                                 "a b",
                                 "a\n",
                                 "a\\b"})
    EXPECT_FALSE(is_case_name(name)) << name;
  EXPECT_FALSE(is_case_name(std::string("a\0b", 3)));
  EXPECT_TRUE(is_case_name(std::string(250, 'a')));
  EXPECT_FALSE(is_case_name(std::string(251, 'a')));
  EXPECT_TRUE(is_key("0123456789abcdef0123456789abcdef"));
  for (const std::string key : {"",
                                "0123456789abcdef",
                                "0123456789ABCDEF0123456789abcdef",
                                "/home/me/precious.txt/0123456789",
                                "0123456789abcdef0123456789abcdef0"})
    EXPECT_FALSE(is_key(key)) << key;
}

TEST_F(ForeignTest, KeysOfAShardDoNotLeadOutOfTheStore) {
  const std::string away = (out_ / "precious").string();
  for (const std::string& key : {away, std::string("../../precious")}) {
    json line = line_;
    line["info"]["keys"][0] = line["record"]["key"] = key;
    forge(line);
    EXPECT_TRUE(is_named([&] { load_results(out_ / "store"); }, journal_));
    EXPECT_TRUE(
        is_named([&] { merge({out_ / "store"}, out_ / "merged"); }, journal_));
    EXPECT_EQ(outside(), "kept");
  }
  EXPECT_THROW(remove_state(out_ / "store", "../../precious"), StoreError);
  EXPECT_THROW(read_state(out_ / "store", "../../precious"), StoreError);
  EXPECT_EQ(outside(), "kept");
}

TEST_F(ForeignTest, LinksInAStoreAreNotFollowed) {
  fs::create_directory(out_ / "elsewhere");
  for (const std::string name : {"cases", "checkpoints"}) {
    const fs::path link = out_ / "store" / name;
    fs::remove_all(link);
    fs::create_directory_symlink(out_ / "elsewhere", link);
    write_file(out_ / "elsewhere" / info_.keys[0], "kept");
    EXPECT_TRUE(is_named([&] { Store store(out_ / "store"); }, link));
    EXPECT_TRUE(fs::exists(out_ / "elsewhere" / info_.keys[0]));
    fs::remove(link);
  }
  for (const std::string name : {"plan.json", "journal.jsonl"}) {
    const fs::path link = out_ / "store" / name;
    fs::remove(link);
    fs::create_symlink(out_ / "precious", link);
    EXPECT_TRUE(is_named([&] { load_results(out_ / "store"); }, link));
    EXPECT_TRUE(is_named([&] { Store store(out_ / "store"); }, link));
    EXPECT_EQ(outside(), "kept");
    fs::remove(link);
  }
}

TEST_F(ForeignTest, LinesOfOtherTypesAreNamed) {
  std::size_t wrong = 0;
  for_each_wrong(line_, [&](const json& line) {
    wrong += is_named([&] { parse_journal(header_ + sealed(line), journal_); },
                      journal_);
  });
  EXPECT_GT(wrong, 500U);
  for_each_wrong(json{{"schema_version", 1}}, [&](const json& line) {
    try {
      is_named([&] { parse_journal(sealed(line), journal_); }, journal_);
    } catch (const UnreadableInput&) {  // a newer version
    }
  });
  EXPECT_TRUE(is_named(
      [&] {
        const auto text = deep();
        parse_journal(header_ + fmt::format("{:08x} {}\n", crc32c(text), text),
                      journal_);
      },
      journal_));
}

TEST_F(ForeignTest, LinesThatAreReadDoNotFailLater) {
  for_each_wrong(line_, [&](const json& line) {
    forge(line);
    is_named([&] { load_results(out_ / "store"); }, out_ / "store");
  });
}

TEST_F(ForeignTest, PlansOfOtherTypesAreNamed) {
  const fs::path path = out_ / "store" / "plan.json";
  fs::remove(out_ / "store" / "results.json");  // which says otherwise
  std::size_t wrong = 0;
  for_each_wrong(plan_, [&](json plan) {
    if (plan.is_object()) {
      plan.erase("checksum");
      const auto version = plan["schema_version"];
      plan["checksum"] = fmt::format("{:08x}", crc32c(plan.dump()));
    }
    try {
      const bool named = is_named(
          [&] {
            std::string ignored;
            parse_plan(plan.dump(), path, &ignored);
          },
          path);
      wrong += named;
      if (named) return;
      // What is read does not fail later.
      write_file(path, plan.dump());
      const Catalog catalog = Catalog::read(out_ / "store");
      catalog.cases(), catalog.order();
      results_json({}, {}, catalog.plan.at("context"));
      extend_plan(catalog.plan, plan_);
      merge({out_ / "store"}, out_ / "merged");
      fs::remove_all(out_ / "merged");
    } catch (const UnreadableInput&) {
    }
  });
  EXPECT_GT(wrong, 100U);
  std::string ignored;
  EXPECT_TRUE(is_named([&] { parse_plan(deep(), path, &ignored); }, path));
}

TEST_F(ForeignTest, HeadersOfStatesAreChecked) {
  const json head = {{"case", "a"}, {"stage", "b"}, {"iteration", 3}};
  const auto state = [](const std::string& text) {
    const auto all = " " + text;
    return fmt::format("{:08x}{}", crc32c(all), all);
  };
  EXPECT_EQ(parse_state(state(head.dump() + "\nabc"), "path").bytes, "abc");
  for_each_wrong(head, [&](const json& wrong) {
    const bool right = wrong.is_object() && wrong.contains("stage") &&
                       wrong.value("case", json()).is_string() &&
                       wrong.value("stage", json()).is_string() &&
                       wrong.value("iteration", json()) == 3;
    EXPECT_NE(
        is_named([&] { parse_state(state(wrong.dump() + "\nabc"), "path"); },
                 "path"),
        right)
        << wrong;
  });
  for (const std::string text : {"", "{", "\n", "abc\n"})
    EXPECT_TRUE(is_named([&] { parse_state(state(text), "path"); }, "path"));
  EXPECT_TRUE(
      is_named([&] { parse_state(state(head.dump()), "path"); }, "path"))
      << "no end of the header";
  EXPECT_TRUE(
      is_named([&] { parse_state(state(deep() + "\n"), "path"); }, "path"));
}

TEST_F(ForeignTest, ResultsOfOtherTypesAreNamedOrExported) {
  const fs::path path = out_ / "store" / "results.json";
  const Json good = parse_results(read_file(path), path);
  ASSERT_FALSE(good["context"]["physinv"].contains("checksum"));
  std::size_t wrong = 0;
  for_each_wrong(good, [&](const Json& results) {
    wrong += is_named(
        [&] {
          const auto read = parse_results(results.dump(), path);
          if (results_version(read) < kResultsVersion) return;
          benchmark_csv(benchmark_json(read));
          smaller_is_better(read);
          bencher_metrics(read);
        },
        path);
  });
  EXPECT_GT(wrong, 200U);
  EXPECT_TRUE(is_named([&] { parse_results(deep(), path); }, path));
}

/// A digit changed in what a campaign left is not read as good.
TEST_F(ForeignTest, FlippedDigitsOfDerivedFilesAreFound) {
  const fs::path results = out_ / "store" / "results.json";
  write_repetitions(out_ / "store", {{"a b", {{1.25, 2.5}}}});
  const fs::path times = out_ / "store" / "repetitions.json";
  const auto flips = [](const fs::path& path, auto&& read) {
    const auto text = read_file(path);
    EXPECT_NO_THROW(read(text));
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] < '0' || text[i] > '9') continue;
      auto wrong = text;
      wrong[i] = static_cast<char>(wrong[i] ^ 1);
      EXPECT_THROW(read(wrong), StoreError) << path << " at " << i;
    }
  };
  flips(results, [&](const auto& text) { parse_results(text, results); });
  flips(times, [&](const auto& text) { parse_repetitions(text, times); });
}

TEST_F(ForeignTest, RepetitionsOfOtherTypesAreNamed) {
  const Json good = {{"times", {{"a b", {{1.5, 2}}}}}};
  EXPECT_EQ(parse_repetitions(good.dump(), "path").at("a b").size(), 1U);
  std::size_t wrong = 0;
  for_each_wrong(good, [&](const Json& times) {
    wrong += is_named([&] { parse_repetitions(times.dump(), "path"); }, "path");
  });
  EXPECT_GT(wrong, 20U);
  EXPECT_TRUE(is_named([&] { parse_repetitions(deep(), "path"); }, "path"));
}

TEST_F(ForeignTest, PublishedNumbersOfOtherTypesAreNamed) {
  const json good = {{"publication",
                      {{"key", "a"},
                       {"title", "b"},
                       {"authors", {"c"}},
                       {"year", 2022},
                       {"venue", "d"}}},
                     {"values",
                      {{{"experiment", "a/b"},
                        {"quantity", "c"},
                        {"value", 1.5},
                        {"spread", nullptr},
                        {"where", "Table 1"}}}}};
  Published published;
  published.add(good.dump(), "path");
  EXPECT_EQ(published.find("a/b", "c")->value, 1.5);
  std::size_t wrong = 0;
  for_each_wrong(good, [&](const json& other) {
    wrong += is_named([&] { published.add(other.dump(), "path"); }, "path");
  });
  EXPECT_GT(wrong, 80U);
  EXPECT_TRUE(is_named([&] { published.add(deep(), "path"); }, "path"));
  EXPECT_TRUE(
      is_named([&] { Published(out_ / "nowhere"); }, (out_ / "nowhere")));
}

/// A case file in which something stands for what is elsewhere.
class ForeignArrays : public testing::Test {
 protected:
  hdf5::Handle file_ = hdf5::new_file();
};

TEST_F(ForeignArrays, NamesThatStandForOtherFilesAreNotFollowed) {
  H5Lcreate_external(
      "/etc/passwd", "/x", file_, "external", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_soft("/elsewhere", file_, "soft", H5P_DEFAULT, H5P_DEFAULT);
  for (const char* name : {"external", "soft"}) {
    const auto says = fmt::format("{} is a link to another file", name);
    EXPECT_EQ(message_of<StoreError>([&] { hdf5::read_batch(file_, name); }),
              says);
    EXPECT_EQ(message_of<StoreError>([&] { hdf5::open_group(file_, name); }),
              says);
  }
}

TEST_F(ForeignArrays, NumbersThatStandInOtherFilesAreNotRead) {
  TemporaryDirectory out;
  write_file(out / "secret", std::string(32, 'x'));
  const hsize_t shape[] = {2, 2};
  const hdf5::Handle space(
      H5Screate_simple(2, shape, nullptr), H5Sclose, "make a shape");
  const auto put = [&](const char* name, auto&& arrange) {
    const hdf5::Handle options(
        H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make a list");
    arrange(options);
    const hdf5::Handle set(H5Dcreate2(file_,
                                      name,
                                      H5T_IEEE_F64LE,
                                      space,
                                      H5P_DEFAULT,
                                      options,
                                      H5P_DEFAULT),
                           H5Dclose,
                           "create an array");
    const double zeros[4] = {};
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros);
  };
  put("external", [&](hid_t options) {
    H5Pset_external(options, (out / "secret").c_str(), 0, 32);
  });
  put("filtered", [&](hid_t options) {
    const hsize_t chunk[] = {2, 2};
    H5Pset_chunk(options, 2, chunk);
    H5Pset_shuffle(options);
  });
  for (const char* name : {"external", "filtered"})
    EXPECT_EQ(
        message_of<StoreError>([&] { hdf5::read_batch(file_, name); }),
        fmt::format(
            "array {} has another storage layout than this program writes",
            name));
}

TEST(ForeignCaseFile, ArraysFitTogether) {
  const auto info = sample_case("jpo", 4, 0);
  const std::vector<std::function<void(StageRecord&)>> wrongs = {
      [](auto& r) { r.status.pop_back(); },
      [](auto& r) { r.example_iterations.conservativeResize(2); },
      [](auto& r) { r.x = sample_batch(2, 5, 0); },
      [](auto& r) { r.curve.seconds.pop_back(); },
      [](auto& r) { r.curve.evaluations.clear(); },
      [](auto& r) { r.curve.loss = sample_batch(4, 4, 0); },
      [](auto& r) { r.curve.x = sample_batch(4, 6, 0); },
      [](auto& r) { r.status[0] = static_cast<Status>(200); }};
  for (const auto& spoil : wrongs) {
    auto record = sample_stage(info, 0);
    spoil(record);
    CaseFile file(info.name);
    file.put_stage(record, hex64(arrays_hash(record)));
    EXPECT_THROW(file.read_stage(record, hex64(arrays_hash(record))),
                 StoreError);
  }
}

}  // namespace
}  // namespace physinv
