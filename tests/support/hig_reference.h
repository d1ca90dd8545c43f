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
inline double hig_hash(std::uint32_t k) {
  k ^= k >> 16;
  k *= 0x85ebca6bU;
  k ^= k >> 13;
  k *= 0xc2b2ae35U;
  k ^= k >> 16;
  return k / 4294967296.0;
}

/// v_i = 2 hash(offset + i) - 1
inline Vector<double> hig_probe(Index size, std::uint32_t offset) {
  return Vector<double>::NullaryExpr(size, [=](Index i) {
    return 2 * hig_hash(offset + static_cast<std::uint32_t>(i)) - 1;
  });
}

/// Nested lists in the order of their numbers.
inline Vector<double> flat(const Json& value) {
  std::vector<double> all;
  const auto walk = [&](const auto& self, const Json& v) -> void {
    if (!v.is_array()) return all.push_back(number(v));
    for (const Json& item : v) self(self, item);
  };
  walk(walk, value);
  return Eigen::Map<const Vector<double>>(all.data(),
                                          static_cast<Index>(all.size()));
}

/// |a - b| <= rel |b| + abs in the 2-norm.
class TwoNorm {
 public:
  TwoNorm(double rel, double abs) : rel_(rel), abs_(abs) {}

  template <class A, class B>
  testing::AssertionResult operator()(const Eigen::MatrixBase<A>& a,
                                      const Eigen::MatrixBase<B>& b) const {
    if (a.size() != b.size()) {
      return testing::AssertionFailure()
             << "size " << a.size() << ", expected " << b.size();
    }
    const Vector<double> u = a.template cast<double>().reshaped();
    const Vector<double> v = b.template cast<double>().reshaped();
    return within((u - v).norm(), v.norm());
  }

  testing::AssertionResult operator()(double a, double b) const {
    return within(std::abs(a - b), std::abs(b));
  }

  /// A vector of which the file stores length, norm, every stride-th entry
  /// and a dot product; the last is held against the length of the vector.
  template <class A>
  testing::AssertionResult summary(const Eigen::MatrixBase<A>& a,
                                   const Json& stored) const {
    const Vector<double> v = a.template cast<double>();
    if (v.size() != stored.at("length").get<Index>())
      return testing::AssertionFailure() << "length " << v.size();
    const double norm = number(stored.at("norm2"));
    if (auto same = (*this)(v.norm(), norm); !same) return same << " (norm)";
    const Vector<double> entries = flat(stored.at("entries"));
    const auto stride = stored.at("stride").get<Index>();
    if ((v.size() + stride - 1) / stride != entries.size())
      return testing::AssertionFailure() << "stride " << stride;
    const Vector<double> picked =
        v(Eigen::seqN(0, entries.size(), stride)).eval();
    if (auto same = (*this)(picked, entries); !same)
      return same << " (entries)";
    const Vector<double> probe =
        hig_probe(v.size(), stored.at("probe_offset").get<std::uint32_t>());
    return within(std::abs(probe.dot(v) - number(stored.at("probe_dot"))), norm)
           << " (probe)";
  }

 private:
  testing::AssertionResult within(double difference, double size) const {
    const double allowed = rel_ * size + abs_;
    if (difference <= allowed) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << "off by " << difference << ", allowed " << allowed << " of size "
           << size;
  }

  double rel_, abs_;
};

/// What an entry expects. A key that is never asked for fails the test.
class Expected {
 public:
  explicit Expected(const Json& entry) : values_(entry.at("expected")) {}
  ~Expected() {
    for (const auto& [key, value] : values_.items())
      EXPECT_TRUE(read_.contains(key)) << "no test reads " << key;
  }
  Expected(const Expected&) = delete;
  Expected& operator=(const Expected&) = delete;

  bool contains(const std::string& key) const { return values_.contains(key); }
  const Json& at(const std::string& key) {
    read_.insert(key);
    return values_.at(key);
  }
  std::vector<std::string> keys() const {
    std::vector<std::string> all;
    for (const auto& [key, value] : values_.items()) all.push_back(key);
    return all;
  }

 private:
  Json values_;
  std::set<std::string> read_;
};

/// The limits of one entry; forms nobody here knows are an error.
class HigTolerance {
 public:
  explicit HigTolerance(const Json& entry) : limits_(entry.at("tolerance")) {
    static const std::set<std::string> known = {
        "rel", "abs", "why", "delta_rel", "delta_rel_strict"};
    for (const auto& [key, value] : limits_.items()) {
      if (!known.contains(key))
        throw std::runtime_error("unknown tolerance form " + key);
    }
  }

  /// All arrays but updates.
  TwoNorm array() const { return {limits_.at("rel"), limits_.at("abs")}; }

  /// Updates by way of a Gram matrix (cuts from 1e-6), or of a singular value
  /// decomposition (`strict`, and all smaller cuts).
  TwoNorm delta(bool strict) const {
    const char* key = strict ? "delta_rel_strict" : "delta_rel";
    return {limits_.value(key, number(limits_.at("rel"))), limits_.at("abs")};
  }

 private:
  Json limits_;
};

}  // namespace physinv::test
