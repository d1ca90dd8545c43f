/// Made-up campaigns for the tests of the store.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "suite/core/dataset.h"
#include "suite/store/case_file.h"
#include "suite/store/checksum.h"
#include "suite/store/file.h"
#include "suite/store/record.h"
#include "tests/support/bits.h"

namespace physinv {

/// A directory that is deleted at the end.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    auto name =
        (std::filesystem::temp_directory_path() / "physinv-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline CaseInfo sample_case(const std::string& method,
                            Index n,
                            std::uint64_t seed) {
  CaseInfo info;
  info.experiment = "jpo/sample";
  info.method = method;
  info.profile = "smoke";
  info.n = n;
  info.seed = seed;
  info.name = fmt::format("jpo/sample/{}/n={}/seed={}", method, n, seed);
  info.stages = {"fit", "refine"};
  for (const auto& stage : info.stages)
    info.keys.push_back(hex128(info.name + stage));
  return info;
}

/// What `body` is given: JSON of the same shape in which one value is of
/// another type or size, or is missing; one after the other.
template <class Json, class F>
void for_each_wrong(const Json& good, F&& body) {
  const Json others[] = {nullptr,
                         true,
                         -7,
                         1e300,
                         18446744073709551615U,
                         "../../text",
                         Json::array(),
                         Json::array({3}),
                         Json::object(),
                         Json::object({{"a", 3}})};
  std::vector<std::string> places;
  const std::function<void(const Json&, const std::string&)> collect =
      [&](const Json& value, const std::string& at) {
        places.push_back(at);
        if (!value.is_structured()) return;
        const auto items = value.items();
        for (auto item = items.begin(); item != items.end(); ++item) {
          std::string name = item.key();
          for (std::size_t k = 0; (k = name.find('/', k)) != name.npos; k += 2)
            name.replace(k, 1, "~1");
          collect(item.value(), at + "/" + name);
        }
      };
  collect(good, "");
  for (const auto& place : places) {
    const typename Json::json_pointer pointer(place);
    for (const Json& other : others) {
      Json wrong = good;
      wrong[pointer] = other;
      body(wrong);
    }
    if (place.empty()) continue;
    Json wrong = good;
    Json& parent = wrong[pointer.parent_pointer()];
    if (parent.is_object()) parent.erase(pointer.back());
    body(wrong);
  }
}

/// Numbers in [0, 1) that differ with the salt.
inline double sample_number(std::uint64_t salt) {
  return static_cast<double>(mix64(salt) >> 11) * 0x1p-53;
}

inline Batch<double> sample_batch(Index rows, Index cols, std::uint64_t salt) {
  Batch<double> b(rows, cols);
  for (Index i = 0; i < b.size(); ++i)
    b.data()[i] = sample_number(salt + static_cast<std::uint64_t>(i));
  return b;
}

inline CaseData sample_data(const CaseInfo& info) {
  CaseData data;
  data.x = sample_batch(2, info.n, info.seed);
  data.y = sample_batch(3, info.n, info.seed + 1000);
  data.given = Batch<double>(0, info.n);
  data.hash = hex64(content_hash({data.x, data.y, data.given}));
  return data;
}

/// The results depend on the case and stage alone, the times on `run`.
inline StageRecord sample_stage(const CaseInfo& info,
                                Index position,
                                std::uint64_t run = 0,
                                Index parameters = 50) {
  const auto k = static_cast<std::size_t>(position);
  const std::uint64_t salt = hash_text(info.keys[k]);
  StageRecord r;
  r.case_name = info.name;
  r.stage = info.stages[k];
  r.key = info.keys[k];
  r.position = position;
  r.options = {{"rate", "0.001"}, {"gtol", "1e-05"}};
  r.message = "says \"so\"\n\xc3\xa9";
  r.iterations = 3000;
  r.clocks.setup = {sample_number(run), 1e-3};
  r.clocks.data = {0.2, 0.1};
  r.clocks.solve = {0.1 + sample_number(run + 1), 1.0 / 3.0};
  r.counts[Counter::forward] = 12345678901234567ULL;
  r.counts[Counter::skipped_rows] = 3;
  r.buffer_bytes = 1 << 20;
  r.rss_bytes = 3ULL << 32;
  r.crowded = true;
  r.finished = "2024-01-02T03:04:05Z";
  r.revision = "abcdef+dirty";
  r.trajectory = "0123456789abcdef";
  r.run = {.profile = "smoke",
           .host = "here",
           .processor = "a processor",
           .instruction_set = "x86-64-v4",
           .threads = 2,
           .jobs = 3,
           .thread_changes = "4 from iteration 20"};
  r.x = sample_batch(2, info.n, salt);
  r.loss = sample_batch(info.n, 1, salt + 1);
  r.loss(0) = std::numeric_limits<double>::quiet_NaN();
  if (info.n > 2) {
    r.loss(1) = std::numeric_limits<double>::infinity();
    r.loss(2) = -0.0;
  }
  for (Index i = 0; i < info.n; ++i)
    r.status.push_back(static_cast<Status>(i % kStatuses.size()));
  r.example_iterations = sample_batch(info.n, 1, salt + 2);
  r.example_evaluations = sample_batch(info.n, 1, salt + 3);
  for (int p = 0; p < 5; ++p) {
    r.curve.iteration.push_back(p);
    r.curve.seconds.push_back(0.1 * p + 0.01 * sample_number(run));
    r.curve.evaluations.push_back(7 * p);
  }
  r.curve.loss = sample_batch(info.n, 5, salt + 4);
  r.curve.x = sample_batch(4, 5, salt + 5);
  r.curve.x(0, 0) = -std::numeric_limits<double>::infinity();
  r.arrays["parameters"] = sample_batch(parameters, 1, salt + 6);
  r.arrays[ArrayKey::own("empty")] = Batch<double>(0, 3);
  return r;
}

using test::same_bits;

/// Every field and every bit.
inline void expect_same(const StageRecord& a, const StageRecord& b) {
  test::expect_same(a, b);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.options, b.options);
  EXPECT_EQ(a.clocks.setup.wall, b.clocks.setup.wall);
  EXPECT_EQ(a.clocks.data.wall, b.clocks.data.wall);
  EXPECT_EQ(a.clocks.solve.wall, b.clocks.solve.wall);
  EXPECT_EQ(a.clocks.solve.cpu, b.clocks.solve.cpu);
  EXPECT_EQ(a.buffer_bytes, b.buffer_bytes);
  EXPECT_EQ(a.rss_bytes, b.rss_bytes);
  EXPECT_EQ(a.crowded, b.crowded);
  EXPECT_EQ(a.run, b.run);
  EXPECT_EQ(a.finished, b.finished);
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_EQ(a.curve.seconds, b.curve.seconds);
}

inline void write_file(const std::filesystem::path& path,
                       const std::string& bytes) {
  std::filesystem::remove(path);  // file systems flush what is cut to zero
  std::ofstream(path, std::ios::binary) << bytes;
}

/// The message of the E that body() throws; fails without one.
template <class E, class F>
std::string message_of(F&& body) {
  try {
    body();
  } catch (const E& e) {
    return e.what();
  } catch (const std::exception& e) {
    ADD_FAILURE() << "another kind of error: " << e.what();
    return "";
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace physinv
