#include "suite/evidence/status_table.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "suite/evidence/cell.h"
#include "suite/results/ends.h"

namespace physinv {
namespace {

/// Stages of solvers have it: 0 where no step was accepted.
constexpr ArrayKey kFirstStep("first_step");

struct Ends {
  std::string label;
  StatusCounts statuses{};
  Index problems = 0, stayed = 0;
};

Ends& at(std::vector<Ends>& all, const std::string& label) {
  const auto found = std::ranges::find(all, label, &Ends::label);
  return found == all.end() ? all.emplace_back(Ends{.label = label}) : *found;
}

std::string label_of(const CaseInfo& info,
                     const StageRecord& stage,
                     const std::map<std::string, std::string>& titles) {
  const auto title = titles.find(info.method);
  return (title == titles.end() ? info.method : title->second) +
         (info.stages.size() > 1 ? " " + stage.stage : "");
}

std::vector<Ends> ends_of(const Results& results,
                          const std::string& experiment,
                          const std::map<std::string, std::string>& titles) {
  std::vector<Ends> all;
  for (const CaseRecord& c : results.cases()) {
    if (c.info.experiment != experiment) continue;
    for (const StageRecord& s : c.stages) {
      const auto steps = s.arrays.find(kFirstStep);
      if (steps == s.arrays.end() || !has_result(s)) continue;
      Ends& ends = at(all, label_of(c.info, s, titles));
      const StatusCounts counts = count(s.status);
      for (const Status status : kStatuses)
        ends.statuses[static_cast<std::size_t>(status)] +=
            counts[static_cast<std::size_t>(status)];
      ends.problems += static_cast<Index>(s.status.size());
      ends.stayed += (steps->second.array() == 0).count();
    }
  }
  return all;
}

}  // namespace

Table status_table(const Results& results,
                   const std::string& experiment,
                   const std::map<std::string, std::string>& method_titles) {
  Table table{.id = "statuses",
              .title = "How problems ended",
              .digits = 0,
              .corner = "method",
              .note = "Problems of all n and seeds."};
  const std::vector<Ends> all = ends_of(results, experiment, method_titles);
  if (std::ranges::all_of(all, [](const Ends& ends) {
        return ends.stayed == 0 && ends.statuses.front() == ends.problems;
      }))
    return table;
  for (const Ends& ends : all) table.rows.push_back({ends.label, {}});
  const auto add = [&](std::string_view head, auto&& of) {
    if (std::ranges::all_of(all, [&](const Ends& e) { return of(e) == 0; }))
      return;
    table.columns.emplace_back(head);
    for (std::size_t i = 0; i < all.size(); ++i)
      table.rows[i].cells.push_back(cell_of(static_cast<double>(of(all[i]))));
  };
  add("problems", [](const Ends& ends) { return ends.problems; });
  for (const Status s : kStatuses)
    add(to_string(s), [at = static_cast<std::size_t>(s)](const Ends& ends) {
      return ends.statuses[at];
    });
  add("stayed", [](const Ends& ends) { return ends.stayed; });
  table.note += table.columns.back() == "stayed"
                    ? " Stayed: no step was accepted, the result is the start."
                    : " None stayed at its start.";
  return table;
}

}  // namespace physinv
