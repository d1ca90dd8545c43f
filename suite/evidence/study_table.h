/// Studies: a number of each setting, next to what the paper prints or states
/// of it. All of them are conditions of a claim and cells of a table.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "suite/evidence/cell.h"
#include "suite/evidence/condition.h"
#include "suite/evidence/of_experiment.h"

namespace physinv {

template <class Setting>
struct StudyColumn {
  using Of = std::function<Quantity(const Setting&)>;
  using Asks = std::function<Condition(std::string, Quantity, const Setting&)>;

  /// Next to what the text states of it, if it does.
  StudyColumn(std::string head, Of number, Asks bound = nullptr)
      : title(std::move(head)), of(std::move(number)), asks(std::move(bound)) {}
  /// Next to a number of the papers' files.
  StudyColumn(std::string head, Of number, std::string name)
      : title(std::move(head)),
        of(std::move(number)),
        printed(std::move(name)) {}

  std::string title;
  Of of;
  Asks asks;
  std::string printed;
};

/// What a text may state, whatever the setting.
inline auto asks_above(double bound) {
  return [=](std::string label, Quantity q, const auto&) {
    return above(std::move(label), std::move(q), bound);
  };
}
inline auto asks_below(double bound) {
  return [=](std::string label, Quantity q, const auto&) {
    return below(std::move(label), std::move(q), bound);
  };
}
inline auto asks_at_most(double bound) {
  return [=](std::string label, Quantity q, const auto&) {
    return at_most(std::move(label), std::move(q), bound);
  };
}
inline auto asks_within(double lowest, double highest) {
  return [=](std::string label, Quantity q, const auto&) {
    return within(std::move(label), std::move(q), lowest, highest);
  };
}

template <class Setting>
struct StudyTable {
  std::vector<Setting> settings;
  std::vector<StudyColumn<Setting>> columns;
  std::function<std::string(const Setting&)> title;
  /// Of a setting that is one of its own; without, that which asks.
  std::function<std::string(const Setting&)> experiment = nullptr;
  Index seeds = 1;  ///< that printed numbers are means of

  Quantity quantity(const Setting& s, const StudyColumn<Setting>& c) const {
    return experiment ? of_experiment(experiment(s), c.of(s)) : c.of(s);
  }
  Condition condition(const Setting& s, const StudyColumn<Setting>& c) const {
    std::string label = fmt::format("{}: {}", title(s), c.title);
    if (!c.printed.empty())
      return as_printed(std::move(label), quantity(s, c), c.printed, seeds);
    return c.asks ? c.asks(std::move(label), quantity(s, c), s)
                  : reported(std::move(label), quantity(s, c));
  }
  /// Every column of every setting.
  std::vector<Condition> conditions() const {
    std::vector<Condition> all;
    for (const Setting& s : settings)
      for (const auto& c : columns) all.push_back(condition(s, c));
    return all;
  }
  /// `table` with the columns, and a row for each setting.
  Table rows(Table table,
             const Evidence& e,
             Cell (*cell)(const Measured&) = cell_of) const {
    for (const auto& c : columns) table.columns.push_back(c.title);
    for (const Setting& s : settings) {
      TableRow row{.label = title(s)};
      for (const auto& c : columns) {
        const Cell own = cell(quantity(s, c)(e));
        row.cells.push_back(
            c.printed.empty() ? own : beside_printed(own, e, c.printed));
      }
      table.rows.push_back(std::move(row));
    }
    return table;
  }
};

}  // namespace physinv
