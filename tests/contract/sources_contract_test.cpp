// What the registered stages say about their sources, against the files as
// they are, and against what the compiler sees.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

#include "cmake/tokens.h"
#include "suite/core/hash.h"
#include "suite/harness/child.h"
#include "suite/harness/keys.h"
#include "suite/harness/sources.h"
#include "tests/support/registered.h"

namespace physinv::test {
namespace {

namespace fs = std::filesystem;

using Names = std::set<std::string>;

/// Everything that a stage and those before it reach.
Names reached(const Case& c, std::size_t position) {
  return project_sources().closure(
      chain_sources(*c.experiment, *c.method, position));
}

/// Of every registered method, whether or not a profile has it.
const Names& reached_by_any() {
  static const Names kAll = [] {
    Names all;
    for (const auto& e : registry().experiments())
      for (const Method& m : e->methods)
        all.merge(project_sources().closure(
            chain_sources(*e, m, m.chain.size() - 1)));
    return all;
  }();
  return kAll;
}

Names with_prefix(const Names& files, const std::string& prefix) {
  Names some;
  for (const auto& file : files)
    if (file.starts_with(prefix)) some.insert(file);
  return some;
}

std::string text_of(const std::string& path) {
  std::ifstream file(fs::path(PHYSINV_SOURCE_DIR) / path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(SourcesContract, BfgsNeedsItsProblemAndNoNetwork) {
  const Case c = small_case(registry().find("jpo/billiards"), "bfgs", 4, 2);
  const Names files = reached(c, 0);
  EXPECT_TRUE(files.contains("problems/billiards/billiards.cpp"));
  EXPECT_TRUE(files.contains("optimizers/bfgs.cpp"));
  EXPECT_TRUE(files.contains("suite/core/oracle.cpp"));
  EXPECT_EQ(with_prefix(files, "problems/").size(), 2u);
  EXPECT_EQ(with_prefix(files, "suite/nn/"), Names());
  EXPECT_EQ(with_prefix(files, "suite/cases/"), Names());
  EXPECT_FALSE(files.contains("optimizers/gradient_descent.cpp"));
}

TEST(SourcesContract, ChainsNeedWhatTheirFirstStagesNeed) {
  const Case c = small_case(registry().find("jpo/billiards"), "jpo", 4, 2);
  const Names fit = reached(c, 0), refined = reached(c, 1);
  EXPECT_TRUE(fit.contains("suite/nn/mlp.cpp"));
  EXPECT_TRUE(fit.contains("suite/nn/linear.cpp"));
  EXPECT_FALSE(fit.contains("suite/nn/conv.cpp"));
  EXPECT_FALSE(fit.contains("optimizers/bfgs.cpp"));
  EXPECT_TRUE(
      std::includes(refined.begin(), refined.end(), fit.begin(), fit.end()));
  EXPECT_TRUE(refined.contains("optimizers/bfgs.cpp"));
}

TEST(SourcesContract, AFirstOrderRuleNeedsNoHalfInverse) {
  const auto toy = registry().find("hig/toy-gamma-0p01");
  ASSERT_NE(toy, nullptr);
  const Names adam = reached(small_case(toy, "adam", 4, 2), 0);
  const Names hig = reached(small_case(toy, "hig", 4, 2), 0);
  EXPECT_EQ(with_prefix(adam, "optimizers/half_inverse"), Names());
  EXPECT_GT(with_prefix(hig, "optimizers/half_inverse").size(), 10u);
  EXPECT_TRUE(adam.contains("optimizers/steps/adam.h"));
  EXPECT_FALSE(adam.contains("optimizers/steps/rmsprop.h"));
  EXPECT_FALSE(hig.contains("optimizers/steps/adam.h"));
}

/// A recorded metric is a function of a Snapshot: its file counts, and it
/// holds no claims, as those need results, which no number may come from.
TEST(SourcesContract, FilesOfMetricsAreReached) {
  int metrics = 0;
  for (const SourceFile& file : build_info().sources) {
    const std::string path(file.path);
    if (!path.starts_with("suite/cases/")) continue;
    if (text_of(path).find("Snapshot") == std::string::npos) continue;
    ++metrics;
    EXPECT_TRUE(reached_by_any().contains(path)) << path;
  }
  EXPECT_GT(metrics, 0);
}

/// An implementation that has not its header's name would be forgotten.
TEST(SourcesContract, NoSourceIsForgotten) {
  // Powers of ten and what texts say are settings, which are in the keys
  // themselves.
  const Names exceptions = {"suite/core/decimal.h",
                            "suite/core/power_of_ten.h"};
  Names forgotten;
  for (const SourceFile& file : build_info().sources) {
    const std::string path(file.path);
    if (path.starts_with("suite/cases/") || reached_by_any().contains(path))
      continue;
    forgotten.insert(path);
  }
  EXPECT_EQ(forgotten, exceptions);
}

// ---- edits ------------------------------------------------------------------

/// The sources of this build with one of them edited or more added.
class Edited {
 public:
  Edited& edit(const std::string& path, const std::string& hash = "edited") {
    hash_ = hash;
    for (SourceFile& file : files_)
      if (file.path == path) file.hash = hash_, ++edits_;
    return *this;
  }
  Edited& add(const char* path, const char* includes) {
    files_.push_back({path, "new", includes});
    ++edits_;
    return *this;
  }
  /// Stages of the profile that become stale, "case stage".
  Names stale() const {
    EXPECT_GT(edits_, 0);
    const SourceGraph after(build_info().foundation, files_);
    std::map<std::pair<const Method*, std::size_t>, bool> known;
    Names names;
    for (const Case& c : registry().expand("quick")) {
      for (std::size_t k = 0; k < c.info.stages.size(); ++k) {
        const auto [at, fresh] = known.try_emplace({c.method, k});
        if (fresh) {
          const auto chain = chain_sources(*c.experiment, *c.method, k);
          at->second =
              after.fingerprint(chain) != project_sources().fingerprint(chain);
        }
        if (at->second) names.insert(c.info.name + ' ' + c.info.stages[k]);
      }
    }
    return names;
  }

 private:
  std::vector<SourceFile> files_{build_info().sources.begin(),
                                 build_info().sources.end()};
  std::string hash_;
  int edits_ = 0;
};

Names stale_after(const std::string& path) {
  return Edited().edit(path).stale();
}

/// True if all of them are of experiments and stages that the patterns name.
testing::AssertionResult all_match(const Names& names,
                                   const std::string& pattern) {
  const std::regex regex(pattern);
  for (const auto& name : names)
    if (!std::regex_match(name, regex))
      return testing::AssertionFailure() << name;
  return names.empty() ? testing::AssertionFailure() << "none"
                       : testing::AssertionSuccess();
}

TEST(SourcesContract, NewFilesMakeNothingStale) {
  EXPECT_EQ(Edited()
                .add("problems/new/new.h", "suite/core/problem.h ")
                .add("problems/new/new.cpp", "problems/new/new.h ")
                .stale(),
            Names());
  EXPECT_EQ(Edited()
                .add("optimizers/new.cpp", "suite/core/method.h ")
                .add("suite/nn/new.h", "suite/nn/layer.h ")
                .add("suite/cases/new.cpp", "optimizers/metrics.h ")
                .stale(),
            Names());
}

TEST(SourcesContract, EditsMakeStaleWhoUsesThem) {
  const auto edits = [](const std::string& path, const std::string& who) {
    EXPECT_TRUE(all_match(stale_after(path), who)) << path;
  };
  edits("problems/billiards/billiards.cpp",
        "(jpo|matrix|numerics)/billiards/.*");
  edits("problems/kuramoto_sivashinsky/etdrk2.cpp",
        "(jpo|matrix|numerics)/kuramoto-sivashinsky.*");
  edits("problems/marker_flow/frequency_loss.cpp",
        "(sip|matrix)/fluid.*|numerics/(marker-flow|transport)/.*");
  edits("optimizers/bfgs.cpp", "jpo/.* (solve|refine)");
  edits("suite/linalg/tridiagonalize.cpp",
        "(hig|numerics/half-inverse).*|(jpo|matrix)/.*/(gn|hig)/.*");
  edits("optimizers/steps/rmsprop.h", "(hig|matrix|physgrad|sip)/.*rmsprop.*");
  edits(
      "suite/nn/unet.cpp",
      "jpo/(kuramoto|navier|wave).*/na/.*|(sip|matrix)/(fluid|heat|poisson).*");
}

std::string hash_of(const std::string& text) {
  return hex128(source::substance(source::tokens_of(text)));
}

/// A token on each line, with a comment.
std::string reformatted(const std::string& text) {
  std::string lines;
  for (const source::Token& token : source::tokens_of(text))
    lines += token.text + "  // it's \"one\"\n";
  return lines;
}

TEST(SourcesContract, CommentsAndFormattingMakeNothingStale) {
  const std::string path = "optimizers/bfgs.cpp", text = text_of(path);
  EXPECT_EQ(Edited().edit(path, hash_of(text)).stale(), Names());
  EXPECT_EQ(Edited()
                .edit(path, hash_of("// New words.\n" + reformatted(text)))
                .stale(),
            Names());
  std::string other = text;
  const auto at = other.find("return");
  ASSERT_NE(at, std::string::npos);
  other.insert(at, "++");
  EXPECT_EQ(Edited().edit(path, hash_of(other)).stale(), stale_after(path));
}

TEST(SourcesContract, EverySourceHasTheHashOfItsTokens) {
  for (const SourceFile& file : build_info().sources) {
    const std::string text = text_of(std::string(file.path));
    EXPECT_EQ(hash_of(text), file.hash) << file.path;
    EXPECT_EQ(hash_of(reformatted(text)), file.hash) << file.path;
    EXPECT_EQ(source::includes(source::tokens_of(text)), file.includes);
  }
}

// ---- the compiler's word ----------------------------------------------------

/// Headers of this project that the compiler's preprocessor reads for each
/// source alone. Others it neither finds nor needs (-MG).
std::map<std::string, Names> compiled_dependencies(const Names& sources) {
  std::vector<std::string> command = {"env",
                                      "-C",
                                      PHYSINV_SOURCE_DIR,
                                      PHYSINV_COMPILER,
                                      "-std=c++20",
                                      "-MM",
                                      "-MG",
                                      "-nostdinc",
                                      "-nostdinc++",
                                      "-I."};
  command.insert(command.end(), sources.begin(), sources.end());
  std::istringstream words(run_child(std::move(command)).output);
  std::map<std::string, Names> all;
  Names* headers = nullptr;
  for (std::string word; words >> word;) {
    if (word.ends_with(":"))
      headers = nullptr;
    else if (word == "\\")  // the line continues
      continue;
    else if (headers == nullptr)
      headers = &all[word];
    else if (project_sources().find(word) == word)
      headers->insert(word);
  }
  return all;
}

/// What a source includes, directly or not, as it was scanned.
Names scanned_headers(const std::string& source) {
  static const auto kIncludes = [] {
    std::map<std::string, std::string> all;
    for (const SourceFile& file : build_info().sources)
      all[std::string(file.path)] = file.includes;
    return all;
  }();
  Names found;
  std::vector<std::string> next = {source};
  while (!next.empty()) {
    std::istringstream names(kIncludes.at(next.back()));
    next.pop_back();
    for (std::string name; names >> name;)
      if (kIncludes.contains(name) && found.insert(name).second)
        next.push_back(name);
  }
  return found;
}

TEST(SourcesContract, TheCompilerConfirmsWhatIncludesWhat) {
  Names sources;
  for (const SourceFile& file : build_info().sources) {
    const std::string path(file.path);
    // Claims and figures also read what makes no numbers and is not scanned.
    const bool of_cases = path.starts_with("suite/cases/");
    if (path.ends_with(".cpp") &&
        (!of_cases || project_sources().errors({.roots = {path}}).empty()))
      sources.insert(path);
  }
  const auto compiled = compiled_dependencies(sources);
  EXPECT_EQ(compiled.size(), sources.size());
  for (const auto& [path, headers] : compiled)
    EXPECT_EQ(scanned_headers(path), headers) << path;
}

}  // namespace
}  // namespace physinv::test
