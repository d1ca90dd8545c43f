#include "reports/joined_tables.h"

#include <algorithm>
#include <utility>

namespace physinv {
namespace {

/// A table and the experiment whose it is.
struct Part {
  const Table* table;
  const std::string* experiment;  ///< its title
};

bool belong_together(const Table& a, const Table& b) {
  return a.where == b.where && a.title == b.title && a.columns == b.columns;
}

/// Groups of tables that belong together, in the order of their first ones.
std::vector<std::vector<Part>> groups_of(const std::vector<Section>& sections,
                                         const std::string& paper) {
  std::vector<std::vector<Part>> groups;
  for (const Section& s : sections) {
    if (s.paper != paper || !s.experiment.starts_with(paper + "/")) continue;
    for (const Table& t : s.tables) {
      if (!t.where.starts_with("Table ")) continue;
      const auto same =
          std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
            return belong_together(*group.front().table, t);
          });
      (same == groups.end() ? groups.emplace_back() : *same)
          .push_back({&t, &s.title});
    }
  }
  return groups;
}

/// Has it a row alone, which is called like the experiment?
bool is_a_row(const Part& part) {
  return part.table->rows.size() == 1 &&
         part.table->rows.front().label == *part.experiment;
}

Table joined(const std::vector<Part>& group) {
  Table all = *group.front().table;
  all.rows.clear();
  const bool named = std::all_of(group.begin(), group.end(), is_a_row);
  if (!named) {
    if (all.keys.empty()) all.keys = {all.corner};
    all.keys.insert(all.keys.begin(), "experiment");
    all.corner = "experiment, " + all.corner;
  }
  for (const Part& part : group)
    for (TableRow row : part.table->rows) {
      if (!named) {
        if (row.keys.empty()) row.keys = {row.label};
        row.keys.insert(row.keys.begin(), *part.experiment);
        row.label = *part.experiment + ", " + row.label;
      }
      all.rows.push_back(std::move(row));
    }
  all.note = "Sizes and seeds stand below the table of each experiment.";
  return all;
}

}  // namespace

std::vector<Table> joined_tables(const std::vector<Section>& sections,
                                 const std::string& paper) {
  std::vector<Table> tables;
  for (const auto& group : groups_of(sections, paper))
    if (group.size() > 1) tables.push_back(joined(group));
  return tables;
}

}  // namespace physinv
