// The list of folders (suite/cases/common/experiments.def) against what they
// register.
#include "suite/cases/common/folders.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace physinv {
namespace {

using Names = std::vector<std::string>;

/// Names of experiments by folder.
std::map<std::string, Names> listed() {
  std::map<std::string, Names> all;
  for (const CaseFolder& folder : folders())
    all[folder.path] = folder.experiments;
  return all;
}

bool covers(const std::string& listed, const std::string& name) {
  return listed.ends_with('*')
             ? name.starts_with(listed.substr(0, listed.size() - 1))
             : name == listed;
}

TEST(Folders, HaveTheExperimentsOfTheirLineAlone) {
  const auto all = listed();
  EXPECT_EQ(folders().size(), all.size()) << "lines of one folder together";
  std::size_t experiments = 0;
  for (const CaseFolder& folder : folders()) {
    Registry own;
    folder.add(own);
    experiments += own.experiments().size();
    for (const auto& e : own.experiments()) {
      std::string lines;
      for (const auto& [path, names] : all)
        for (const std::string& name : names)
          if (covers(name, e->name)) lines += path + " ";
      EXPECT_EQ(lines, folder.path + " ") << e->name;
    }
    for (const std::string& name : folder.experiments)
      EXPECT_TRUE(std::any_of(own.experiments().begin(),
                              own.experiments().end(),
                              [&](auto& e) { return covers(name, e->name); }))
          << folder.path << " has no " << name;
  }
  EXPECT_EQ(experiments, registry().experiments().size());
}

Names ids(const std::vector<Claim>& claims) {
  Names all;
  for (const Claim& c : claims) all.push_back(c.id);
  return all;
}

/// A page of a program over one folder lacks nothing of its experiments.
TEST(Folders, HaveTheClaimsAndPagesOfTheirExperiments) {
  int claims = 0, reports = 0;
  for (const CaseFolder& folder : folders()) {
    Registry own;
    folder.add(own);
    for (const auto& e : own.experiments()) {
      const auto whole = registry().find(e->name);
      ASSERT_TRUE(whole) << e->name;
      EXPECT_EQ(ids(e->claims), ids(whole->claims)) << e->name;
      EXPECT_EQ(static_cast<bool>(e->report), static_cast<bool>(whole->report))
          << e->name;
      claims += static_cast<int>(e->claims.size());
      reports += e->report ? 1 : 0;
    }
  }
  EXPECT_GT(claims, 200);
  EXPECT_GT(reports, 50);
}

}  // namespace
}  // namespace physinv
