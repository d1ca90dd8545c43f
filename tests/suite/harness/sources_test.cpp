// Which edits make which stages stale, on a little suite of three stages.
#include "suite/harness/sources.h"

#include <gtest/gtest.h>

#include <map>

namespace physinv {
namespace {

using Files = std::map<std::string, std::pair<std::string, std::string>>;

/// Path, content and includes of every source.
const Files kSuite{
    {"core/batch.h", {"1", ""}},
    {"core/method.h", {"1", "core/batch.h core/oracle.h "}},
    {"core/oracle.h", {"1", "core/batch.h "}},
    {"core/oracle.cpp", {"1", "core/oracle.h core/rng.h "}},
    {"core/rng.h", {"1", ""}},
    {"core/rng.cpp", {"1", "core/rng.h "}},
    {"nn/layer.h", {"1", "core/batch.h "}},
    {"nn/linear.h", {"1", "nn/layer.h "}},
    {"nn/linear.cpp", {"1", "nn/linear.h "}},
    {"nn/norm.h", {"1", "nn/layer.h "}},
    {"nn/norm.cpp", {"1", "nn/norm.h "}},
    {"nn/mlp.h", {"1", ""}},
    {"nn/mlp.cpp", {"1", "nn/mlp.h nn/linear.h nn/norm.h "}},
    {"problems/heat/heat.h", {"1", "core/batch.h "}},
    {"problems/heat/heat.cpp", {"1", "problems/heat/heat.h "}},
    {"problems/wave/wave.h", {"1", "core/batch.h "}},
    {"problems/wave/wave.cpp", {"1", "problems/wave/wave.h "}},
    {"steps/rule.h", {"1", "steps/adam.h steps/sgd.h "}},
    {"steps/adam.h", {"1", "core/batch.h "}},
    {"steps/sgd.h", {"1", "core/batch.h "}},
    {"methods/bfgs.h", {"1", "core/method.h "}},
    {"methods/bfgs.cpp", {"1", "methods/bfgs.h "}},
    {"methods/train.h", {"1", "core/method.h steps/rule.h "}},
    {"methods/train.cpp", {"1", "methods/train.h "}},
    {"cases/heat_metrics.h", {"1", "core/method.h "}},
    {"cases/heat_metrics.cpp", {"1", "cases/heat_metrics.h "}},
    {"cases/heat.cpp", {"1", "problems/heat/heat.h methods/train.h "}}};

using Chain = std::vector<Sources>;

const Sources kBfgs{
    .roots = {"/home/me/suite/methods/bfgs.cpp", "problems/heat/heat.h"},
    .unused = {}};
const Sources kTrain{
    .roots = {"/home/me/suite/methods/train.cpp",
              "problems/heat/heat.h",
              "nn/mlp.cpp",
              "cases/heat_metrics.cpp"},
    .unused = {{"steps/rule.h", "steps/sgd.h"}, {"nn/mlp.cpp", "nn/norm.h"}}};
const Sources kWave{.roots = {"methods/train.cpp", "problems/wave/wave.h"},
                    .unused = {{"steps/rule.h", "steps/adam.h"}}};

const std::map<std::string, Chain> kStages{{"heat/bfgs", {kBfgs}},
                                           {"heat/train", {kTrain}},
                                           {"heat/refine", {kTrain, kBfgs}},
                                           {"wave/train", {kWave}}};

SourceGraph graph(const Files& files, const char* foundation = "gcc") {
  std::vector<SourceFile> list;
  for (const auto& [path, file] : files)
    list.push_back({path, file.first, file.second});
  return SourceGraph(foundation, list);
}

/// Stages with another fingerprint in the second graph.
std::set<std::string> stale(const SourceGraph& before,
                            const SourceGraph& after) {
  std::set<std::string> names;
  for (const auto& [name, chain] : kStages)
    if (before.fingerprint(chain) != after.fingerprint(chain))
      names.insert(name);
  return names;
}

std::set<std::string> stale_after_edit(const std::string& path) {
  Files files = kSuite;
  files.at(path).first = "2";
  return stale(graph(kSuite), graph(files));
}

using Names = std::set<std::string>;
const Names kNone, kAll{"heat/bfgs", "heat/train", "heat/refine", "wave/train"};
const Names kTrained{"heat/train", "heat/refine"};

TEST(Sources, WhatIsNewMakesNothingStale) {
  Files files = kSuite;
  files["problems/new/new.h"] = {"1", "core/batch.h "};
  files["problems/new/new.cpp"] = {"1", "problems/new/new.h "};
  files["methods/new.cpp"] = {"1", "methods/train.h steps/rule.h "};
  files["nn/new.h"] = {"1", "nn/layer.h "};
  files["cases/new.cpp"] = {"1", "problems/new/new.h methods/bfgs.h "};
  EXPECT_EQ(stale(graph(kSuite), graph(files)), kNone);
}

TEST(Sources, EditsMakeStaleWhoUsesThem) {
  EXPECT_EQ(stale_after_edit("cases/heat.cpp"), kNone);
  EXPECT_EQ(stale_after_edit("core/batch.h"), kAll);
  EXPECT_EQ(stale_after_edit("core/rng.cpp"), kAll);  // behind three headers
  EXPECT_EQ(stale_after_edit("problems/heat/heat.cpp"),
            (Names{"heat/bfgs", "heat/train", "heat/refine"}));
  EXPECT_EQ(stale_after_edit("problems/wave/wave.h"), Names{"wave/train"});
  EXPECT_EQ(stale_after_edit("methods/bfgs.cpp"),
            (Names{"heat/bfgs", "heat/refine"}));
  EXPECT_EQ(stale_after_edit("methods/train.h"),
            (Names{"heat/train", "heat/refine", "wave/train"}));
  EXPECT_EQ(stale_after_edit("nn/linear.cpp"), kTrained);
  EXPECT_EQ(stale_after_edit("cases/heat_metrics.cpp"), kTrained);
}

TEST(Sources, OptionsWithoutEffectAreNoSources) {
  EXPECT_EQ(stale_after_edit("nn/norm.cpp"), kNone);
  EXPECT_EQ(stale_after_edit("steps/adam.h"), kTrained);
  EXPECT_EQ(stale_after_edit("steps/sgd.h"), Names{"wave/train"});
  // A stage of the chain that takes it counts, whatever another leaves out.
  const Chain both{kTrain, kWave};
  Files files = kSuite;
  files.at("steps/adam.h").first = "2";
  EXPECT_NE(graph(kSuite).fingerprint(both), graph(files).fingerprint(both));
  // So does another way to the same header.
  files = kSuite;
  files.at("steps/adam.h").second = "steps/sgd.h ";
  const auto before = graph(files);
  files.at("steps/sgd.h").first = "2";
  EXPECT_EQ(stale(before, graph(files)),
            (Names{"heat/train", "heat/refine", "wave/train"}));
}

TEST(Sources, ANewLineOrFoundationCountsToo) {
  Files files = kSuite;
  files.at("methods/bfgs.cpp") = {"2", "methods/bfgs.h nn/norm.h "};
  const SourceGraph longer = graph(files);
  EXPECT_TRUE(longer.closure(kBfgs).contains("nn/norm.cpp"));
  EXPECT_EQ(stale(graph(kSuite), graph(kSuite, "clang")), kAll);
  EXPECT_EQ(graph(kSuite).fingerprint({kBfgs}).size(), 32u);
}

TEST(Sources, WhatIsWrongIsNamed) {
  const SourceGraph good = graph(kSuite);
  EXPECT_TRUE(good.errors(kTrain).empty());
  EXPECT_EQ(
      good.errors({.roots = {"/home/problems/haet/haet.h"}, .unused = {}}),
      std::vector<std::string>{
          "there is no source '/home/problems/haet/haet.h'"});
  EXPECT_EQ(
      good.errors({.roots = {"steps/rule.h"},
                   .unused = {{"steps/rule.h", "steps/sdg.h"}}}),
      std::vector<std::string>{"steps/rule.h does not include steps/sdg.h"});
  Files files = kSuite;
  files.at("cases/heat_metrics.cpp").second += "results/results.h ";
  EXPECT_EQ(graph(files).errors(kTrain),
            std::vector<std::string>{
                "results depend on cases/heat_metrics.cpp, but changes of "
                "results/results.h would not invalidate "
                "them"});
  // The table of arrays moves no number, so that no graph has it.
  files = kSuite;
  files.at("core/method.h").second += "suite/core/array_table.h ";
  EXPECT_EQ(graph(files).errors(kTrain), std::vector<std::string>());
  EXPECT_THROW(good.fingerprint({{.roots = {"a.cpp"}, .unused = {}}}),
               std::logic_error);
}

// ---- from outside -----------------------------------------------------------

/// A user's problem by a method of the suite and a user's rule.
struct Project {
  std::vector<SourceFile> files{
      {"mine/drop.h", "1", "core/batch.h mine/src/drop.cpp "},
      {"mine/src/drop.cpp", "1", "mine/drop.h "},
      {"mine/rule.cpp", "1", "core/method.h "},
      {"mine/heat.h", "1", ""}};
  std::string root = "/home/me/mine";

  SourceGraph graph() const {
    std::vector<SourceFile> suite;
    for (const auto& [path, file] : kSuite)
      suite.push_back({path, file.first, file.second});
    const Outside outside{.name = "drops",
                          .project = "mine",
                          .root = root,
                          .plugin = false,
                          .sources = files};
    return SourceGraph("gcc", suite, std::span(&outside, 1));
  }
  std::string after_edit(std::size_t which, const Chain& chain) {
    files[which].hash = "2";
    const auto text = graph().fingerprint(chain);
    files[which].hash = "1";
    return text;
  }
};

const Chain kDrop{{.roots = {"/home/me/mine/rule.cpp", "problems/drop/drop.h"},
                   .unused = {}}};

TEST(Sources, OfProjectsAreFoundByPlaceAndByName) {
  const SourceGraph g = Project().graph();
  EXPECT_EQ(g.closure(kDrop),
            (Names{"core/batch.h",
                   "core/method.h",
                   "core/oracle.cpp",
                   "core/oracle.h",
                   "core/rng.cpp",
                   "core/rng.h",
                   "mine/drop.h",
                   "mine/rule.cpp",
                   "mine/src/drop.cpp"}));
  EXPECT_EQ(g.find("/home/me/mine/src/drop.cpp"), "mine/src/drop.cpp");
  EXPECT_EQ(g.find("/prefix/methods/bfgs.cpp"), "methods/bfgs.cpp");
  EXPECT_EQ(g.find("/home/me/mine"), "");
  EXPECT_EQ(g.find("/home/me/mine2/src/none.cpp"), "");
  EXPECT_TRUE(g.errors(kDrop.front()).empty());
  // The suite's come first.
  EXPECT_EQ(g.find("problems/heat/heat.h"), "problems/heat/heat.h");
}

TEST(Sources, EditsOutsideMakeStaleWhoUsesThem) {
  Project p;
  const auto drop = p.graph().fingerprint(kDrop);
  const auto bfgs = p.graph().fingerprint({kBfgs});
  EXPECT_EQ(bfgs, graph(kSuite).fingerprint({kBfgs}));
  for (const std::size_t used : {0U, 1U, 2U})
    EXPECT_NE(p.after_edit(used, kDrop), drop) << used;
  EXPECT_EQ(p.after_edit(3, kDrop), drop);
  EXPECT_EQ(p.after_edit(0, {kBfgs}), bfgs);
  p.root = "/elsewhere";  // a moved checkout
  const Chain moved{
      {.roots = {"/elsewhere/rule.cpp", "problems/drop/drop.h"}, .unused = {}}};
  EXPECT_EQ(p.graph().fingerprint(moved), drop);
}

TEST(Sources, WhatIsMissingOutsideSaysWhereItBelongs) {
  const auto wrong = Project().graph().errors(
      {.roots = {"problems/rain/rain.h"}, .unused = {}});
  ASSERT_EQ(wrong.size(), 1U);
  EXPECT_NE(wrong[0].find("list its file in SOURCES"), std::string::npos);
}

TEST(Sources, TwoProjectsWithOneNameAreToldApart) {
  const std::vector<SourceFile> a{{"a/drop.h", "1", ""}},
      b{{"b/drop.h", "1", ""}};
  const std::vector<Outside> both{
      {.name = "a", .project = "a", .root = "/a", .sources = a},
      {.name = "b", .project = "b", .root = "/b", .sources = b}};
  const SourceGraph g("gcc", {}, both);
  EXPECT_EQ(g.find("/b/drop.h"), "b/drop.h");
  EXPECT_EQ(g.find("b/drop.h"), "b/drop.h");
  EXPECT_EQ(
      g.errors({.roots = {"problems/drop/drop.h"}, .unused = {}}),
      std::vector<std::string>{"'problems/drop/drop.h' is ambiguous: a/drop.h "
                               "or b/drop.h; give one of these paths in full"});
}

}  // namespace
}  // namespace physinv
