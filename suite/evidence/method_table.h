/// Tables with a row for each method.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "suite/evidence/cell.h"
#include "suite/evidence/training_report.h"

namespace physinv {

/// What a table says of the runs of a method.
struct MethodColumn {
  std::string head;
  std::function<Cell(const Evidence&, const Select&)> cell;
};

/// A quantity of them, written with three digits.
MethodColumn quantity_column(std::string head,
                             std::function<Quantity(const Select&)> of);
/// The median of a number of each run.
MethodColumn median_column(std::string head, RunValue value);

/// `table` with these columns, and a row for each line that was run.
Table table_by_method(Table table,
                      const Evidence& evidence,
                      const std::vector<MethodLine>& lines,
                      const std::vector<MethodColumn>& columns);

}  // namespace physinv
