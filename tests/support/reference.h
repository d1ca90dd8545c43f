/// Reference vectors of independent implementations, and what their tolerance
/// forms mean.
///
/// A test takes every setting from the entry, so that entries of the same kind
/// on other inputs run as well. What it cannot take, and every key that it does
/// not read, is a failure that names key and value.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/network.h"
#include "tests/support/json.h"
#include "tests/support/tolerance.h"

namespace physinv::test {

/// The environment may point the same tests at another folder.
std::string reference_dir();

/// Whether the folder has such a file.
bool has_reference(const std::string& id);
/// All entries of a file, each a document of its own.
std::vector<Json> all_entries(const std::string& id);
/// Those of this name; a file may hold several.
std::vector<Json> reference_entries(const std::string& id,
                                    const std::string& name);
/// The one that other entries speak about. Of several whose names begin with
/// `name` it is the first; without one it throws.
Json spoken_of(const std::string& id, const std::string& name);

double number(const Json& value);
/// Of so many numbers, or it throws; any number where none is given, here and
/// below.
constexpr Index kAny = -1;
Vector<double> vector(const Json& list, Index size = kAny);
/// A list of samples becomes features x samples.
Batch<double> columns(const Json& samples,
                      Index features = kAny,
                      Index count = kAny);
/// A list of rows becomes a matrix with those rows.
Batch<double> rows(const Json& list, Index count = kAny, Index columns = kAny);
/// A field, which is a list of rows, as it lies in memory.
Vector<double> field(const Json& list, Index rows = kAny, Index columns = kAny);
/// A list of such fields, one per column.
Batch<double> fields(const Json& list);

/// A setting of an entry: what `key` of its inputs says (or of the entry
/// itself), else the number behind `words` in its description, else what the
/// specification says.
double setting(const Json& entry,
               const std::string& key,
               const std::string& words,
               double specified);
/// "MLP 32-128-128-128-2" and "MLP [1, 64, 1]" of a description; `specified`
/// where it says nothing.
std::vector<Index> layer_sizes(const Json& entry, std::vector<Index> specified);
/// "(37,506 parameters" of a description, where it says so.
void expect_parameters(const Json& entry, Index found);
/// M9: an entry with formula weights and no shift of its own uses that of the
/// nearest earlier entry, else 0.
double formula_shift(const std::string& id, const Json& entry);
/// Batches that are named in words: the field's own list, or that of
/// another entry ("the batch of unet-forward-16x16").
Json batch_of(const std::string& id, const Json& batch, const std::string& key);

/// The formula that the test carries out must be the one in the file.
void expect_formula(const Json& in,
                    const std::string& key,
                    const std::string& formula);

/// u(k) = 2 ((a k^2 + b k + c) mod m) / (m - 1) - 1.
class Recurrence {
 public:
  explicit Recurrence(const Json& rule);

  Index residue(Index k) const { return (a_ * k * k + b_ * k + c_) % m_; }
  double operator()(Index k) const {
    return 2.0 * double(residue(k)) / double(m_ - 1) - 1;
  }
  /// +-1, by parity.
  double sign(Index k) const { return residue(k) % 2 == 0 ? 1 : -1; }

 private:
  Index a_, b_, c_, m_;
};

/// Parameters numbered through all tensors: s u(k) / sqrt(fan_in), of a
/// normalisation 1 + u / 10 and u / 10, of modes u / 64. The rule's lists must
/// fit the network.
Vector<double> recurrence_weights(const Json& rule,
                                  const std::vector<TensorInfo>& tensors);

/// The norm of each tensor's part.
Vector<double> tensor_norms(const std::vector<TensorInfo>& tensors,
                            const Vector<double>& gradient);

/// The tolerance forms of one entry. An unknown form is an error, so that no
/// comparison is silently loosened or dropped. A `tolerance_note` (or `note`)
/// next to `rtol` is a formula for the test of that entry.
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

/// What a check throws becomes a failure, as does a key that it did not read.
void check_entry(const Json& entry, const EntryCheck& check);

/// Runs the check of every entry's name; a name that ends in * stands for all
/// that begin so. Entries `elsewhere` are read by another test of the file; one
/// that nothing reads is an error, and so is a file without any for this test.
/// The suite's own file has an entry for each check.
void check_entries(const std::string& id,
                   const std::map<std::string, EntryCheck>& checks,
                   const std::set<std::string>& elsewhere = {});

/// The same for tests of one kind of entry, of which several files may speak;
/// all other names are somebody else's.
void check_entries_named(const std::string& id,
                         const std::string& name,
                         const EntryCheck& check);

/// The names of a file, all of which must be known to its tests.
void expect_known_entries(const std::string& id,
                          const std::set<std::string>& known);

/// In float and in double.
template <class F, class D>
EntryCheck in_both(F in_float, D in_double) {
  return [=](const Json& entry) {
    {
      SCOPED_TRACE("float");
      in_float(entry);
    }
    SCOPED_TRACE("double");
    in_double(entry);
  };
}

}  // namespace physinv::test
