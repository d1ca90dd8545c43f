#include "suite/store/missing_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "suite/store/catalog.h"

namespace physinv {
namespace {}  // namespace

bool MissingWork::any() const {
  return unknown_plan || !unrun_cases.empty() || !unrun_stages.empty() ||
         !failed.empty() || !lost.empty();
}

void MissingWork::add(const Catalog& catalog, const CaseRecord& c) {
  const auto& info = c.info;
  for (std::size_t k = 0; k < info.stages.size(); ++k) {
    ++stages;
    const std::string name = info.name + " " + info.stages[k];
    const auto position = static_cast<Index>(k);
    const auto found = std::find_if(
        c.stages.begin(), c.stages.end(), [&](const StageRecord& s) {
          return s.position == position;
        });
    if (found != c.stages.end()) {
      if (!has_result(*found)) failed.push_back(name);
      continue;
    }
    const JournalEntry* line = catalog.at(info.name, position);
    const bool ran = line != nullptr && k < info.keys.size() &&
                     line->stage.key == info.keys[k];
    (ran ? lost : unrun_stages).push_back(name);
  }
}

MissingWork missing_work(const Catalog& catalog,
                         const std::vector<CaseRecord>& cases) {
  std::map<std::string, const CaseRecord*> by_name;
  for (const CaseRecord& c : cases) by_name[c.info.name] = &c;
  MissingWork lacks;
  lacks.unknown_plan = !catalog.plan.is_object();
  for (const auto& name : catalog.order()) {
    const auto at = by_name.find(name);
    if (at != by_name.end()) {
      lacks.add(catalog, *at->second);
    } else if (catalog.knows_case(name)) {
      lacks.add(catalog, {.info = catalog.info_of(name)});
    } else {
      lacks.unrun_cases.push_back(name);
    }
  }
  return lacks;
}

std::string to_text(const MissingWork& lacks) {
  std::string text =
      lacks.unknown_plan
          ? "plan.json is missing, so the selected cases are unknown"
          : "";
  const auto add = [&](const auto& names, std::string_view what) {
    if (names.empty()) return;
    text += fmt::format("{}{} {} (first {})",
                        text.empty() ? "" : ", ",
                        names.size(),
                        what,
                        names.front());
  };
  add(lacks.unrun_cases, "cases not run");
  add(lacks.unrun_stages, "stages not run");
  add(lacks.failed, "stages failed");
  add(lacks.lost, "stages lost their arrays");
  return text;
}

}  // namespace physinv
