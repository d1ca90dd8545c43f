// What the folders of experiments define, the table of all that is written from
// them calls by its name: another name would be an experiment that is left out
// unseen.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Functions of a source that take the registry.
std::vector<std::string> functions_of(const std::string& source) {
  static const std::regex kFunction("\nvoid (\\w+)\\(Registry& r\\)");
  std::vector<std::string> names;
  for (std::sregex_iterator at(source.begin(), source.end(), kFunction), end;
       at != end;
       ++at)
    names.push_back((*at)[1].str());
  return names;
}

/// What is wrong with the folders of a paper.
std::vector<std::string> missing(const fs::path& paper) {
  std::vector<std::string> wrong;
  for (const auto& folder : fs::directory_iterator(paper)) {
    if (!folder.is_directory() || folder.path().filename() == "common")
      continue;
    std::size_t functions = 0;
    for (const auto& file : fs::directory_iterator(folder)) {
      if (file.path().extension() != ".cpp") continue;
      const auto names = functions_of(text_of(file.path()));
      functions += names.size();
      for (const std::string& name : names)
        if (!name.starts_with("add_"))
          wrong.push_back(file.path().string() + ": nothing calls " + name);
    }
    if (functions == 0)
      wrong.push_back(folder.path().string() + " adds nothing to the registry");
  }
  return wrong;
}

TEST(Registration, WhatFoldersDefineIsCalled) {
  int papers = 0;
  for (const auto& paper :
       fs::directory_iterator(fs::path(PHYSINV_SOURCE_DIR) / "suite/cases")) {
    if (!paper.is_directory() || paper.path().filename() == "common") continue;
    ++papers;
    for (const std::string& line : missing(paper.path())) ADD_FAILURE() << line;
  }
  EXPECT_GE(papers, 6);
}

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

TEST(Registration, AFunctionOfAnotherNameIsFound) {
  const fs::path paper = fs::path(testing::TempDir()) / "registration/paper";
  fs::remove_all(paper);
  const auto source = [](const std::string& name) {
    return "\nnamespace physinv::drop {\n\nvoid " + name +
           "(Registry& r) {\n}\n";
  };
  write(paper / "drop/experiment.cpp", source("add_experiments"));
  EXPECT_TRUE(missing(paper).empty());
  write(paper / "drop/claims.cpp", source("state_claims"));
  EXPECT_EQ(missing(paper).size(), 1u);
  write(paper / "empty/claims.cpp", "\nnamespace physinv::empty {\n");
  EXPECT_EQ(missing(paper).size(), 2u);
  fs::remove_all(paper);
}

/// No source of the suite registers by itself.
TEST(Registration, NothingRegistersWhenItIsLoaded) {
  const std::regex by_itself("register_(experiment|overview|claims|report)\\(");
  for (const auto& file : fs::recursive_directory_iterator(
           fs::path(PHYSINV_SOURCE_DIR) / "suite/cases")) {
    if (file.path().extension() != ".cpp") continue;
    EXPECT_FALSE(std::regex_search(text_of(file.path()), by_itself))
        << file.path();
  }
}

}  // namespace
