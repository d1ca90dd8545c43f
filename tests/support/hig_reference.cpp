#include "tests/support/hig_reference.h"

#include <cmath>
#include <stdexcept>

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

Vector<double> flat(const Json& value) {
  std::vector<double> all;
  const auto walk = [&](const auto& self, const Json& v) -> void {
    if (!v.is_array()) return all.push_back(number(v));
    for (const Json& item : v) self(self, item);
  };
  walk(walk, value);
  return Eigen::Map<const Vector<double>>(all.data(),
                                          static_cast<Index>(all.size()));
}

testing::AssertionResult TwoNorm::compare(const Vector<double>& a,
                                          const Vector<double>& b) const {
  if (a.size() != b.size()) {
    return testing::AssertionFailure()
           << "size " << a.size() << ", expected " << b.size();
  }
  return within((a - b).norm(), b.norm());
}

testing::AssertionResult TwoNorm::operator()(double a, double b) const {
  return within(std::abs(a - b), std::abs(b));
}

testing::AssertionResult TwoNorm::summary_of(const Vector<double>& v,
                                             const Json& stored) const {
  if (v.size() != stored.at("length").get<Index>())
    return testing::AssertionFailure() << "length " << v.size();
  const double norm = number(stored.at("norm2"));
  if (auto same = (*this)(v.norm(), norm); !same) return same << " (norm)";
  const Vector<double> entries = flat(stored.at("entries"));
  const auto stride = stored.at("stride").get<Index>();
  if ((v.size() + stride - 1) / stride != entries.size())
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

Expected::Expected(const Json& entry) : values_(entry.at("expected")) {}

Expected::~Expected() {
  for (const auto& [key, value] : values_.items())
    EXPECT_TRUE(read_.contains(key)) << "no test reads " << key;
}

bool Expected::contains(const std::string& key) const {
  return values_.contains(key);
}

const Json& Expected::at(const std::string& key) {
  read_.insert(key);
  return values_.at(key);
}

std::vector<std::string> Expected::keys() const {
  std::vector<std::string> all;
  for (const auto& [key, value] : values_.items()) all.push_back(key);
  return all;
}

HigTolerance::HigTolerance(const Json& entry) : limits_(entry.at("tolerance")) {
  static const std::set<std::string> known = {
      "rel", "abs", "why", "delta_rel", "delta_rel_strict"};
  for (const auto& [key, value] : limits_.items()) {
    if (!known.contains(key))
      throw std::runtime_error("unknown tolerance form " + key);
  }
}

TwoNorm HigTolerance::array() const {
  return {limits_.at("rel"), limits_.at("abs")};
}

TwoNorm HigTolerance::delta(bool strict) const {
  const char* key = strict ? "delta_rel_strict" : "delta_rel";
  return {limits_.value(key, number(limits_.at("rel"))), limits_.at("abs")};
}

}  // namespace physinv::test
