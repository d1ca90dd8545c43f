/// Reference vectors of independent implementations, and what their tolerance
/// forms mean.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "suite/core/batch.h"
#include "tests/support/tolerance.h"

namespace physinv::test {

using Json = nlohmann::json;

/// The environment may point the same tests at another folder.
std::string reference_dir();
Json load_reference(const std::string& id);

/// All entries of this name; a file may hold several.
std::vector<Json> reference_entries(const std::string& id,
                                    const std::string& name);

/// JSON has no NaN: null stands for a number that is not finite.
double number(const Json& value);
Vector<double> vector(const Json& list);
/// A list of samples becomes features x samples.
Batch<double> columns(const Json& samples);
/// A list of rows becomes a matrix with those rows.
Batch<double> rows(const Json& list);

/// The tolerance forms of one entry. A form nobody here knows is an error, so
/// that no comparison is silently loosened or dropped. A `tolerance_note` (or
/// `note`) beside `rtol` is a formula for the test of that entry.
class EntryTolerance {
 public:
  explicit EntryTolerance(const Json& entry);

  /// Arrays and scalars: `rtol`, `atol`; `scale` multiplies rtol where a note
  /// asks for it.
  Comparator array(double scale = 1) const;

  /// The iterates an optimizer's path can be compared at.
  Comparator iterates() const;
  bool first_only() const;

  /// The final loss of a run against the stored one, by whichever of the
  /// forms the entry has; `otherwise` (relative to max(1, |stored|)) if none.
  testing::AssertionResult final_loss(double loss,
                                      double stored,
                                      double otherwise) const;

 private:
  Json entry_;
};

using EntryCheck = std::function<void(const Json&)>;

/// Runs the check of every entry's name. Entries `elsewhere` are read by
/// another test of the file; one that nobody reads is an error.
void check_entries(const std::string& id,
                   const std::map<std::string, EntryCheck>& checks,
                   const std::set<std::string>& elsewhere = {});

/// Visits the entries whose names `check` knows; the rest must be known to
/// another test of the same file (`others`), or the test fails.
void expect_known_entries(const std::string& id,
                          const std::vector<std::string>& known);

}  // namespace physinv::test
