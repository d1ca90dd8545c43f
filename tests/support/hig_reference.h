/// What the reference files of the half-inverse-gradient experiments share:
/// hashed numbers, arrays stored as summaries, comparison in the 2-norm.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "tests/support/reference.h"

namespace physinv::test {

/// In [0, 1); the generator of all weights and probe vectors in the files.
double hig_hash(std::uint32_t k);

/// v_i = 2 hash(offset + i) - 1
Vector<double> hig_probe(Index size, std::uint32_t offset);

/// Nested lists in the order of their numbers.
Vector<double> flat(const Json& value);

/// |a - b| <= rel |b| + abs in the 2-norm.
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
  /// and a dot product; the last is held against the length of the vector.
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

/// What an entry expects. A key that is never asked for fails the test.
class Expected {
 public:
  explicit Expected(const Json& entry);
  ~Expected();
  Expected(const Expected&) = delete;
  Expected& operator=(const Expected&) = delete;

  bool contains(const std::string& key) const;
  const Json& at(const std::string& key);
  std::vector<std::string> keys() const;

 private:
  Json values_;
  std::set<std::string> read_;
};

/// The limits of one entry; forms nobody here knows are an error.
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
