// Every input of the corpus, as the fuzzers feed it: seeds, and what once
// crashed, hung or ended in an error that is not documented.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "suite/core/clock.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr double kSeconds = 5;  // what a fuzzer would call a hang
const fs::path kCorpus = PHYSINV_SOURCE_DIR "/tests/fuzz/corpus";

struct Reader {
  const char* name;
  void (*read)(std::string_view);
};
void PrintTo(const Reader& reader, std::ostream* out) { *out << reader.name; }

constexpr Reader kReaders[] = {{"baseline", baseline},
                               {"cache", cache},
                               {"case_list", case_list},
                               {"checkpoint", checkpoint},
                               {"claims", claims},
                               {"command_line", command_line},
                               {"config", config},
                               {"digest", digest},
                               {"hdf5", hdf5},
                               {"journal", journal},
                               {"plan", plan},
                               {"published", published},
                               {"repetitions", repetitions},
                               {"results", results},
                               {"store", store},
                               {"submission", submission}};

std::vector<fs::path> inputs(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& file : fs::directory_iterator(folder))
    files.push_back(file.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A gigabyte more than there is now; a sanitizer's shadow takes more.
void limit_memory() {
#ifndef __SANITIZE_ADDRESS__
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = rlim_t{1} << 30;
  setrlimit(RLIMIT_DATA, &limit);
#endif
}

class FuzzCorpus : public ::testing::TestWithParam<Reader> {};

TEST_P(FuzzCorpus, EndsWellOrInADocumentedError) {
  limit_memory();
  const auto files = inputs(kCorpus / GetParam().name);
  EXPECT_GE(files.size(), 3u);
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    const double begin = now().cpu;
    EXPECT_NO_THROW(GetParam().read(bytes_of(file)));
    EXPECT_LT(now().cpu - begin, kSeconds);
  }
}

INSTANTIATE_TEST_SUITE_P(Readers,
                         FuzzCorpus,
                         ::testing::ValuesIn(kReaders),
                         [](const auto& instance) {
                           return std::string(instance.param.name);
                         });

/// A reader without inputs, or inputs without a reader, would be forgotten.
TEST(FuzzCorpus, HasAFolderForEachReader) {
  std::vector<std::string> folders, names;
  for (const auto& folder : inputs(kCorpus))
    folders.push_back(folder.filename().string());
  for (const Reader& reader : kReaders) names.emplace_back(reader.name);
  EXPECT_EQ(folders, names);
}

}  // namespace
}  // namespace physinv::fuzz
