#include "suite/evidence/method_table.h"

#include <utility>

namespace physinv {

MethodColumn quantity_column(std::string head,
                             std::function<Quantity(const Select&)> of) {
  return {std::move(head),
          [of = std::move(of)](const Evidence& e, const Select& runs) {
            return written(of(runs)(e));
          }};
}

MethodColumn median_column(std::string head, RunValue value) {
  return quantity_column(
      std::move(head), [=](const Select& runs) { return median(runs, value); });
}

Table table_by_method(Table table,
                      const Evidence& evidence,
                      const std::vector<MethodLine>& lines,
                      const std::vector<MethodColumn>& columns) {
  for (const MethodColumn& c : columns) table.columns.push_back(c.head);
  for (const MethodLine& line : lines) {
    const Select runs{line.method};
    if (find_runs(evidence, runs).empty()) continue;
    table.rows.push_back(
        {.label = line.label, .cells = each(columns, [&](const auto& column) {
                                return column.cell(evidence, runs);
                              })});
  }
  return table;
}

}  // namespace physinv
