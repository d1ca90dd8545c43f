#include "tests/support/hig_reference.h"

#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

namespace physinv::test {

double hig_hash(std::uint32_t k) {
  k ^= k >> 16;
  k *= 0x85ebca6bU;
  k ^= k >> 13;
  k *= 0xc2b2ae35U;
  k ^= k >> 16;
  return k / 4294967296.0;
}

Vector<double> hig_probe(Index size, std::uint32_t offset) {
  return Vector<double>::NullaryExpr(size, [=](Index i) {
    return 2 * hig_hash(offset + static_cast<std::uint32_t>(i)) - 1;
  });
}

Vector<double> flat(const Json& value, Index size) {
  std::vector<double> all;
  const auto walk = [&](const auto& self, const Json& v) -> void {
    if (!v.is_array()) return all.push_back(number(v));
    for (const Json& item : v) self(self, item);
  };
  walk(walk, value);
  if (size != kAny && size != static_cast<Index>(all.size()))
    throw std::runtime_error(value.path() + " has " +
                             std::to_string(all.size()) +
                             " numbers, expected " + std::to_string(size));
  return Eigen::Map<const Vector<double>>(all.data(),
                                          static_cast<Index>(all.size()));
}

std::map<Index, Vector<double>> states_after(const Json& expected) {
  static const std::string kAfter = "after_";
  std::map<Index, Vector<double>> states;
  for (const std::string& key : expected.keys())
    if (key.starts_with(kAfter))
      states[std::stol(key.substr(kAfter.size()))] = flat(expected.at(key));
  return states;
}

testing::AssertionResult TwoNorm::compare(const Vector<double>& a,
                                          const Vector<double>& b) const {
  if (a.size() != b.size()) {
    return testing::AssertionFailure()
           << "size " << a.size() << ", expected " << b.size();
  }
  Vector<double> off = a - b, size = b;
  for (Index i = 0; i < b.size(); ++i) {
    const bool same = a(i) == b(i) || (std::isnan(a(i)) && std::isnan(b(i)));
    if (same) off(i) = 0;
    if (!std::isfinite(b(i))) size(i) = 0;
    if (!std::isfinite(off(i)))
      return testing::AssertionFailure()
             << "entry " << i << " is " << a(i) << ", expected " << b(i);
  }
  return within(off.stableNorm(), size.stableNorm());
}

testing::AssertionResult TwoNorm::operator()(double a, double b) const {
  return compare(Vector<double>::Constant(1, a),
                 Vector<double>::Constant(1, b));
}

testing::AssertionResult TwoNorm::summary_of(const Vector<double>& v,
                                             const Json& stored) const {
  if (v.size() != stored.at("length").get<Index>())
    return testing::AssertionFailure() << "length " << v.size();
  const double norm = number(stored.at("norm2"));
  if (auto same = (*this)(v.stableNorm(), norm); !same)
    return same << " (norm)";
  const Vector<double> entries = flat(stored.at("entries"));
  const auto stride = stored.at("stride").get<Index>();
  if (stride < 1 || (v.size() + stride - 1) / stride != entries.size())
    return testing::AssertionFailure() << "stride " << stride;
  const Vector<double> picked = v(Eigen::seqN(0, entries.size(), stride));
  if (auto same = compare(picked, entries); !same) return same << " (entries)";
  const Vector<double> probe =
      hig_probe(v.size(), stored.at("probe_offset").get<std::uint32_t>());
  return within(std::abs(probe.dot(v) - number(stored.at("probe_dot"))), norm)
         << " (probe)";
}

testing::AssertionResult TwoNorm::within(double difference, double size) const {
  const double allowed = rel_ * size + abs_;
  if (difference <= allowed) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "off by " << difference << ", allowed "
                                     << allowed << " of size " << size;
}

HigTolerance::HigTolerance(const Json& entry) : limits_(entry.at("tolerance")) {
  static const std::set<std::string> known = {
      "rel", "abs", "why", "delta_rel", "delta_rel_strict"};
  for (const std::string& key : limits_.keys()) {
    if (!known.contains(key))
      throw std::runtime_error("unknown tolerance form " + key);
  }
}

TwoNorm HigTolerance::array() const {
  return {number(limits_.at("rel")), number(limits_.at("abs"))};
}

TwoNorm HigTolerance::delta(bool strict) const {
  const char* key = strict ? "delta_rel_strict" : "delta_rel";
  return {limits_.value(key, number(limits_.at("rel"))),
          number(limits_.at("abs"))};
}

}  // namespace physinv::test
