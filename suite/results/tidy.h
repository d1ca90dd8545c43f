/// A campaign as one table: a row for every example of every stage that was
/// asked for, one value a cell.
///
/// Stages that failed, were skipped, diverged or were not run have a row for
/// each example, too, so that rates are of all: their end is in `status`, and
/// there is no loss, no work and no time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "suite/store/record.h"

namespace physinv {

class Catalog;
struct MissingWork;

/// Of one example. What it points to belongs to the campaign.
struct TidyRow {
  std::string_view case_name, stage;
  const CaseInfo* info = nullptr;       ///< null: the plan has only the name
  const StageRecord* record = nullptr;  ///< null: not run
  std::optional<Index> example;

  /// The example's end (`nonfinite` where its loss is not finite), or that of
  /// a stage that did not do what it was asked for.
  std::string_view status() const;
  bool has_numbers() const;
};

/// A name, with the unit where there is one, and the values below it.
struct TidyColumn {
  using Text = std::string (*)(const TidyRow&);
  using Whole = std::optional<std::int64_t> (*)(const TidyRow&);
  using Real = std::optional<double> (*)(const TidyRow&);
  std::string_view name;
  std::variant<Text, Whole, Real> value;
};
std::span<const TidyColumn> tidy_columns();

/// In the order of the campaign; `cases` and `lacks` are the catalog's.
void for_each_tidy_row(const Catalog& catalog,
                       const std::vector<CaseRecord>& cases,
                       const MissingWork& lacks,
                       const std::function<void(const TidyRow&)>& row);

std::string tidy_csv(const Catalog& catalog,
                     const std::vector<CaseRecord>& cases,
                     const MissingWork& lacks);

}  // namespace physinv
