#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "suite/harness/campaign.h"
#include "suite/harness/columns.h"
#include "suite/harness/progress.h"

namespace physinv {
namespace {

/// The results of the cases of one experiment.
struct Group {
  std::string experiment;
  std::set<std::string> methods;
  std::size_t cases = 0, stages = 0, diverged = 0, failed = 0;
  double seconds = 0;
};

void add(Group& group, const CaseRecord& c) {
  ++group.cases;
  group.methods.insert(c.info.method);
  for (const StageRecord& s : c.stages) {
    ++group.stages;
    if (s.stop == Stop::diverged) ++group.diverged;
    if (s.stop == Stop::failed || s.stop == Stop::skipped) ++group.failed;
    group.seconds += s.clocks.total().wall;
  }
}

/// A revision as people read it.
std::string brief(const std::string& revision) {
  const auto plus = revision.find('+');
  return revision.substr(0, std::min<std::size_t>(12, plus)) +
         (plus == std::string::npos ? "" : revision.substr(plus));
}

}  // namespace

std::string summary_table(const std::vector<CaseRecord>& cases,
                          std::size_t room) {
  std::vector<Group> groups;
  std::map<std::string, std::size_t> index;
  for (const CaseRecord& c : cases) {
    const auto [at, is_new] = index.emplace(c.info.experiment, groups.size());
    if (is_new) groups.push_back({.experiment = c.info.experiment});
    add(groups[at->second], c);
  }
  Columns table({"<experiment",
                 "methods",
                 "cases",
                 "stages",
                 "diverged",
                 "failed",
                 "time"});
  for (const Group& g : groups)
    table.add({g.experiment,
               std::to_string(g.methods.size()),
               std::to_string(g.cases),
               std::to_string(g.stages),
               std::to_string(g.diverged),
               std::to_string(g.failed),
               duration_text(g.seconds)});
  return table.text(room);
}

std::string to_text(const Origins& origins) {
  std::string text;
  for (const auto& [origin, count] : origins) {
    text += fmt::format("{}{} of {} at {}",
                        text.empty() ? "" : ", ",
                        count,
                        origin.first,
                        brief(origin.second));
  }
  return text;
}

}  // namespace physinv
