/// What the reference files of the half-inverse-gradient experiments share:
/// hashed numbers, arrays stored as summaries, comparison in the 2-norm.
#pragma once

#include <cstdint>
#include <map>

#include "tests/support/reference.h"

namespace physinv::test {

/// In [0, 1); the generator of all weights and probe vectors in the files.
double hig_hash(std::uint32_t k);

/// v_i = 2 hash(offset + i) - 1
Vector<double> hig_probe(Index size, std::uint32_t offset);

/// Nested lists in the order of their numbers; of so many, or it throws.
Vector<double> flat(const Json& value, Index size = kAny);

/// The states after_1, after_48, ... of an entry, by their steps.
std::map<Index, Vector<double>> states_after(const Json& expected);

/// |a - b| <= rel |b| + abs in the 2-norm, whatever the size of the numbers.
/// Entries that are not finite must be the same and are left out.
class TwoNorm {
 public:
  TwoNorm(double rel, double abs) : rel_(rel), abs_(abs) {}

  template <class A, class B>
  testing::AssertionResult operator()(const Eigen::MatrixBase<A>& a,
                                      const Eigen::MatrixBase<B>& b) const {
    return compare(a.template cast<double>().reshaped(),
                   b.template cast<double>().reshaped());
  }
  testing::AssertionResult operator()(double a, double b) const;

  /// A vector of which the file stores length, norm, every stride-th entry
  /// and a dot product; the last is compared with the length of the vector.
  template <class A>
  testing::AssertionResult summary(const Eigen::MatrixBase<A>& a,
                                   const Json& stored) const {
    return summary_of(a.template cast<double>(), stored);
  }

 private:
  testing::AssertionResult compare(const Vector<double>& a,
                                   const Vector<double>& b) const;
  testing::AssertionResult summary_of(const Vector<double>& v,
                                      const Json& stored) const;
  testing::AssertionResult within(double difference, double size) const;

  double rel_, abs_;
};

/// The limits of one entry; unknown forms are an error.
class HigTolerance {
 public:
  explicit HigTolerance(const Json& entry);

  /// All arrays but updates.
  TwoNorm array() const;

  /// Updates by way of a Gram matrix (cuts from 1e-6), or of a singular value
  /// decomposition (`strict`, and all smaller cuts).
  TwoNorm delta(bool strict) const;

 private:
  Json limits_;
};

}  // namespace physinv::test
