// What the folders of experiments define for their papers' tables, the tables
// name, each once: a forgotten line would be an experiment that nobody misses.
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

/// "billiards::add_experiments(r);", for each function of a source that takes
/// the registry.
std::vector<std::string> calls_for(const std::string& source) {
  static const std::regex kFunction("\nvoid (\\w+)\\(Registry& r\\)");
  static const std::regex kNamespace("\nnamespace ([\\w:]*::)?(\\w+) \\{");
  std::smatch place;
  std::regex_search(source, place, kNamespace);
  std::vector<std::string> calls;
  for (std::sregex_iterator at(source.begin(), source.end(), kFunction), end;
       at != end;
       ++at)
    calls.push_back(place[2].str() + "::" + (*at)[1].str() + "(r);");
  return calls;
}

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos;
       at = text.find(part, at + 1))
    ++count;
  return count;
}

/// What is wrong with the folders of a paper.
std::vector<std::string> missing(const fs::path& paper) {
  std::string tables;
  for (const auto& folder : {paper.parent_path(), paper})
    for (const char* table : {"experiments.cpp", "claims.cpp"})
      tables += text_of(folder / table);
  std::vector<std::string> wrong;
  for (const auto& folder : fs::directory_iterator(paper)) {
    if (!folder.is_directory() || folder.path().filename() == "common")
      continue;
    int functions = 0;
    for (const auto& file : fs::directory_iterator(folder)) {
      if (file.path().extension() != ".cpp") continue;
      for (const std::string& call : calls_for(text_of(file.path()))) {
        ++functions;
        if (count_of(tables, ' ' + call) != 1)
          wrong.push_back(file.path().string() +
                          ": the tables of its paper "
                          "are to have one line '" +
                          call + "'");
      }
    }
    if (functions == 0)
      wrong.push_back(folder.path().string() + " adds nothing to the registry");
  }
  return wrong;
}

TEST(Registration, TablesNameWhatFoldersDefine) {
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

TEST(Registration, AForgottenLineIsFound) {
  const fs::path paper = fs::path(testing::TempDir()) / "registration/paper";
  fs::remove_all(paper);
  const std::string source =
      "\nnamespace physinv::new_paper::drop {\n\nvoid "
      "add_experiments(Registry& "
      "r) {\n}\n";
  write(paper / "drop/experiment.cpp", source);
  write(paper / "experiments.cpp", "\n");
  EXPECT_EQ(missing(paper).size(), 1u);
  write(paper / "experiments.cpp", "  drop::add_experiments(r);\n");
  EXPECT_TRUE(missing(paper).empty());
  write(paper / "claims.cpp", "  drop::add_experiments(r);\n");
  EXPECT_EQ(missing(paper).size(), 1u) << "twice";
  write(paper / "empty/claims.cpp", "\nnamespace physinv::empty {\n");
  EXPECT_EQ(missing(paper).size(), 2u);
  fs::remove_all(paper);
}

/// Nor does anything of the suite's register by itself.
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
